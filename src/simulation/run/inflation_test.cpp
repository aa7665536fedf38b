// Thick spheres and tubes blown up, against the formulas of incompressible elasticity.
#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/peers/principal_forms.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;
using reference::PrincipalForm;

namespace {

constexpr double inner = 0.01;  // metres
constexpr double outer = 0.02;
constexpr double node_tolerance = 1e-9;

double largest_coordinate(Vec3 p) {
    return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
}

/// Moves the shells of a hollow cube (half-width 1, cavity 1/2) onto spheres. Smooth in each tet: the planes where two
/// coordinates are equal in size are faces of the mesh, as the numbers of cells are even.
Vec3 to_sphere(Vec3 p) {
    const double shell = largest_coordinate(p);
    const double radius = inner + (2 * shell - 1) * (outer - inner);
    const auto turn = [&](double v) { return std::tan(v / shell * std::atan(1.0)); };  // equal angles
    const Vec3 direction{turn(p.x), turn(p.y), turn(p.z)};
    return radius / norm(direction) * direction;
}

/// Likewise for a square tube along z, which keeps its length.
Vec3 to_tube(Vec3 p) {
    const Vec3 flat = to_sphere({p.x, p.y, 0});
    return {flat.x, flat.y, 3 * outer * p.z / 2};
}

struct Hollow {
    mesh::TetMesh mesh;
    Wall wall;
};

/// A cube of side 2 around the origin in n x n x nz cells without those whose centres `empty` names, in quadratic tets
/// that `place` moves where they belong.
Hollow hollow(int n, int nz, const std::function<bool(Vec3)>& empty, Vec3 (*place)(Vec3)) {
    const Vec3 middle{1, 1, 1};
    mesh::TetMesh whole = reference::kuhn_box({2, 2, 2}, n, n, nz, [&](Vec3 c) { return empty(c - middle) ? 1 : 0; });
    whole = mesh::to_quadratic(whole);
    mesh::Extract solid = mesh::extract_regions(whole, {true, false});
    std::vector<mesh::Face> faces;
    for (const mesh::Face& face : mesh::region_faces(whole, 1)) {
        const bool borders_solid = std::none_of(face.nodes.begin(), face.nodes.end(), [&](int node) {
            return solid.node[static_cast<std::size_t>(node)] < 0;
        });
        const Vec3 centre = (whole.points[static_cast<std::size_t>(face.nodes[0])] +
                             whole.points[static_cast<std::size_t>(face.nodes[1])] +
                             whole.points[static_cast<std::size_t>(face.nodes[2])]) /
                                3 -
                            middle;
        if (borders_solid && std::fabs(centre.z) < 1 - node_tolerance)
            faces.push_back(face);  // not the open ends of a tube
    }
    Hollow result{std::move(solid.mesh), wall_of_faces(whole, faces, solid.node)};
    for (Vec3& p : result.mesh.points) p = place(p - middle);
    return result;
}

Hollow sphere(int n) {
    return hollow(
        n, n, [](Vec3 c) { return largest_coordinate(c) < 0.5; }, to_sphere);
}

Hollow tube(int n, int nz) {
    return hollow(
        n, nz, [](Vec3 c) { return std::max(std::fabs(c.x), std::fabs(c.y)) < 0.5; }, to_tube);
}

/// Simpson's rule on `count` (even) pieces.
double integral(const std::function<double(double)>& f, double from, double to, int count = 2000) {
    const double h = (to - from) / count;
    double sum = f(from) + f(to);
    for (int i = 1; i < count; ++i) sum += (i % 2 == 1 ? 4 : 2) * f(from + i * h);
    return sum * h / 3;
}

/// p = integral from l_b to l_a of W'(l) / (l^3 - 1), with W(l) = psi(l^-2, l, l) and the hoop stretches l at the inner
/// and outer wall (Ogden, Non-linear Elastic Deformations, 1984, chapter 5.3).
double sphere_pressure(const PrincipalForm& form, double inner_stretch) {
    const double a3 = std::pow(inner * inner_stretch, 3) - std::pow(inner, 3);
    const double outer_stretch = std::cbrt(a3 + std::pow(outer, 3)) / outer;
    return integral(
        [&](double l) {
            return reference::slope(form, {1 / (l * l), l, l}, {-2 / (l * l * l), 1, 1}) / (l * l * l - 1);
        },
        outer_stretch, inner_stretch);
}

/// Where a point of a tube ends that keeps its length and volume, when the inner radius becomes `a`.
double tube_radius(double rest, double a) {
    return std::sqrt(rest * rest + a * a - inner * inner);
}

/// p = integral from l_b to l_a of W'(l) / (l^2 - 1), with W(l) = psi(1/l, l, 1) (same source).
double tube_pressure(const PrincipalForm& form, double inner_stretch) {
    return integral(
        [&](double l) {
            return reference::slope(form, {1 / l, l, 1}, {-1 / (l * l), 1, 0}) / (l * l - 1);
        },
        tube_radius(outer, inner * inner_stretch) / outer, inner_stretch);
}

Step last_step(Description d) {
    const auto model = Model::create(std::move(d));
    REQUIRE_MESSAGE(model, (model ? "" : model.error().message));
    Progress silent;
    const Trajectory result = run(*model, {.steps = 4, .tolerance = 1e-6}, silent);
    REQUIRE_MESSAGE(result.converged, result.message);
    return result.steps.back();
}

/// Pressure of a sphere whose cavity grows to `stretch` cubed of its volume; three inner nodes, on the axes, follow the
/// formula and hold the sphere in its place. Their reactions must be next to nothing.
double sphere_pressure_found(const material::Law& law, int n, double stretch) {
    Hollow body = sphere(n);
    Description d;
    d.mesh = std::move(body.mesh);
    d.materials = {{"rubber", law, 0}};
    d.material_of_region = {0};
    for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
        const Vec3 at = inner * axis;
        d.supports.push_back({"pole " + std::to_string(d.supports.size()),
                              reference::nodes_where(d.mesh, [&](Vec3 p) { return norm(p - at) < node_tolerance; }),
                              (stretch - 1) * at});
        REQUIRE(d.supports.back().nodes.size() == 1);
    }
    d.chambers = {{"air", std::move(body.wall), {ChamberTarget::Kind::volume_ratio, stretch * stretch * stretch}}};
    const Step last = last_step(std::move(d));
    const double pressure = last.chambers[0].pressure_Pa;
    for (const SupportState& pole : last.supports)
        CHECK(norm(pole.force_N) < 0.01 * pressure * 4 * 3.1416 * inner * inner);
    return pressure;
}

/// Inner radius halfway along a tube under `pressure`, whose ends follow the formula.
double tube_radius_found(const material::Law& law, int n, double stretch, double pressure) {
    Hollow body = tube(n, 4);
    Description d;
    d.mesh = std::move(body.mesh);
    d.materials = {{"rubber", law, 0}};
    d.material_of_region = {0};
    for (std::size_t node = 0; node < d.mesh.points.size(); ++node) {
        const Vec3 p = d.mesh.points[node];
        if (std::fabs(p.z) < 1.5 * outer - node_tolerance) continue;
        const double r = std::hypot(p.x, p.y);
        const double grown = tube_radius(r, inner * stretch) / r - 1;
        d.supports.push_back({"end " + std::to_string(node), {static_cast<int>(node)}, {grown * p.x, grown * p.y, 0}});
    }
    d.pressures = {{"air", std::move(body.wall), pressure}};
    const std::vector<int> ring = reference::nodes_where(d.mesh, [](Vec3 p) {
        return std::fabs(p.z) < node_tolerance && std::fabs(std::hypot(p.x, p.y) - inner) < node_tolerance;
    });
    REQUIRE(ring.size() == static_cast<std::size_t>(4 * n));
    const Step last = last_step(std::move(d));
    double sum = 0;
    for (const int node : ring) {
        const Vec3 x = last.positions[static_cast<std::size_t>(node)];
        sum += std::hypot(x.x, x.y) / static_cast<double>(ring.size());
    }
    return sum;
}

std::vector<PrincipalForm> nearly_incompressible() {
    const double shear = 4e5;
    const double K = material::bulk_modulus(shear, 0.499);
    return {reference::principal_form(material::NeoHookean{shear, K}),
            reference::principal_form(material::MooneyRivlin{0.7 * shear / 2, 0.3 * shear / 2, K})};
}

}  // namespace

TEST_CASE("thick sphere: the integral formula equals the closed form for neo-Hookean") {
    // p = mu/2 (1/b^4 + 4/b - 1/a^4 - 4/a) with the hoop stretches a and b.
    const auto form = nearly_incompressible().front();
    const double a = 1.5;
    const double b = std::cbrt(a * a * a - 1 + 8) / 2;
    const auto half = [](double l) { return 1 / (l * l * l * l) + 4 / l; };
    CHECK(sphere_pressure(form, a) == near(4e5 / 2 * (half(b) - half(a)), {.relative = 1e-9}));
}

TEST_CASE("thick sphere: the pressure at a given cavity converges to the formula") {
    const double stretch = 1.4;
    for (const PrincipalForm& form : nearly_incompressible()) {
        const double expected = sphere_pressure(form, stretch);
        const double coarse = sphere_pressure_found(form.law, 4, stretch) / expected - 1;
        const double fine = sphere_pressure_found(form.law, 8, stretch) / expected - 1;
        MESSAGE(material::name(form.law) << ": formula " << expected << " Pa, off by " << coarse << " and " << fine);
        CHECK(std::fabs(fine) < std::fabs(coarse) / 3);
        CHECK(std::fabs(fine) < 0.01);
    }
}

TEST_CASE("thick tube: under the formula's pressure the radius converges to the formula's") {
    const double stretch = 1.4;
    for (const PrincipalForm& form : nearly_incompressible()) {
        const double pressure = tube_pressure(form, stretch);
        const auto grown = [&](int n, double p) {
            return (tube_radius_found(form.law, n, stretch, p) - inner) / (inner * (stretch - 1));
        };
        const double coarse = grown(4, pressure) - 1;
        const double fine = grown(8, pressure) - 1;
        const double more = grown(4, 1.02 * pressure) - 1;
        MESSAGE(material::name(form.law) << ": pressure " << pressure << " Pa, growth off by " << coarse << " and "
                                         << fine << "; with 2 % more pressure " << more);
        CHECK(std::fabs(fine) < std::fabs(coarse) / 2);
        CHECK(std::fabs(fine) < 0.01);
        CHECK(more - coarse > 0.01);  // the ends do not hide a wrong pressure
    }
}
