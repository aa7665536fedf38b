// The solver against formulas: blocks under homogeneous strain, a slender beam, and the order of convergence.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/core/near.hpp"
#include "simulation/actuators/loads.hpp"
#include "simulation/peers/principal_forms.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;
using reference::kuhn_box;
using reference::PrincipalForm;

namespace {

constexpr double tiny = 1e-9;

Trajectory equilibrium_of(const Description& d, int steps, double tolerance) {
    const auto model = Model::create(d);
    REQUIRE_MESSAGE(model, (model ? "" : model.error().message));
    Progress silent;
    Trajectory result = run(*model, {.steps = steps, .tolerance = tolerance}, silent);
    REQUIRE_MESSAGE(result.converged, result.message);
    return result;
}

/// A unit cube (1 cm) in few cells, with inner nodes. Where `held` says so, each node is a support that follows `move`.
Description cube(int order, int cells, const material::Law& law, const std::function<bool(Vec3)>& held,
                 const std::function<Vec3(Vec3)>& move) {
    Description d;
    d.mesh = kuhn_box({1, 1, 1}, cells, cells, cells, [](Vec3) { return 0; });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"A", law, 0}};
    d.material_of_region = {0};
    for (std::size_t n = 0; n < d.mesh.points.size(); ++n) {
        const Vec3 p = d.mesh.points[n];
        if (held(p)) d.supports.push_back({"node " + std::to_string(n), {static_cast<int>(n)}, move(p)});
    }
    return d;
}

bool on_side(Vec3 p, std::size_t axis) {
    return p[axis] < tiny || p[axis] > 1 - tiny;
}

/// Mean of P over the unit cube: the integral of P is the sum of (outer force) x (rest position) over the nodes.
linalg::Matrix3 mean_stress(const Description& d, const Step& step) {
    linalg::Matrix3 P = linalg::Matrix3::Zero();
    for (std::size_t s = 0; s < d.supports.size(); ++s) {
        const Vec3 f = step.supports[s].force_N;
        const Vec3 X = d.mesh.points[static_cast<std::size_t>(d.supports[s].nodes[0])];
        P += Eigen::Vector3d(f.x, f.y, f.z) * Eigen::RowVector3d(X.x, X.y, X.z);
    }
    return P;
}

/// The cube under principal stretches l: sides across the axes in `pulled` are held, the others are free.
void check_stretch(const PrincipalForm& form, std::array<double, 3> l, std::size_t pulled) {
    CAPTURE(material::name(form.law));
    CAPTURE(pulled);
    const Vec3 expected = form.stress({l[0], l[1], l[2]});
    for (const int order : {1, 2}) {
        CAPTURE(order);
        const auto held = [&](Vec3 p) { return on_side(p, 0) || (pulled == 2 && on_side(p, 1)); };
        const Description d = cube(order, order == 1 ? 3 : 2, form.law, held, [&](Vec3 p) {
            return Vec3{(l[0] - 1) * p.x, (l[1] - 1) * p.y, (l[2] - 1) * p.z};
        });
        const Step last = equilibrium_of(d, 4, 1e-9).steps.back();
        const linalg::Matrix3 P = mean_stress(d, last);
        const double scale = std::fabs(expected.x);
        for (Eigen::Index i = 0; i < 3; ++i) {
            for (Eigen::Index j = 0; j < 3; ++j) {
                const double wanted = i == j ? expected[static_cast<std::size_t>(i)] : 0.0;
                CHECK(std::fabs(P(i, j) - wanted) < 1e-7 * scale);
            }
        }
        CHECK(last.min_J == near(l[0] * l[1] * l[2], {.relative = 1e-7}));
    }
}

/// F = I + g e1 e2^T, with the whole outside held: P12 = d psi / d g.
void check_shear(const PrincipalForm& form, double g) {
    CAPTURE(material::name(form.law));
    for (const int order : {1, 2}) {
        CAPTURE(order);
        const auto outside = [](Vec3 p) { return on_side(p, 0) || on_side(p, 1) || on_side(p, 2); };
        const Description d = cube(order, order == 1 ? 3 : 2, form.law, outside, [&](Vec3 p) {
            return Vec3{g * p.y, 0, 0};
        });
        const linalg::Matrix3 P = mean_stress(d, equilibrium_of(d, 4, 1e-9).steps.back());
        CHECK(P(0, 1) == near(form.shear_stress(g), {.relative = 1e-12}));
        // P F^T is symmetric: the stress turns nothing.
        CHECK(P(1, 0) + g * P(1, 1) == near(P(0, 1), {.relative = 1e-12}));
    }
}

/// u = grad(phi) with phi harmonic has neither divergence nor Laplacian: every term of Navier's equation,
/// mu lap(u) + (lambda + mu) grad(div u) = 0, vanishes, for every E and nu and without body force.
Vec3 harmonic_gradient(Vec3 p) {
    const double k = 2;
    const double q = k / std::numbers::sqrt2;
    const double e = std::exp(k * (p.x - 1));
    const double sy = std::sin(q * p.y + 0.3), cy = std::cos(q * p.y + 0.3);
    const double sz = std::sin(q * p.z + 0.7), cz = std::cos(q * p.z + 0.7);
    return e * Vec3{k * sy * sz, q * cy * sz, q * sy * cz};
}

/// Points and weights of Gauss (3 x 3 x 3) collapsed onto a tet, in barycentric coordinates; weights sum to 1.
std::vector<std::pair<std::array<double, 4>, double>> tet_points() {
    const double node[] = {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)};
    const double weight[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    std::vector<std::pair<std::array<double, 4>, double>> points;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            for (int k = 0; k < 3; ++k) {
                const double a = node[i], b = node[j] * (1 - a), c = node[k] * (1 - a - b);
                const double jacobian = 6 * (1 - a) * (1 - a - b);
                points.push_back({{a, b, c, 1 - a - b - c}, weight[i] * weight[j] * weight[k] * jacobian});
            }
        }
    }
    return points;
}

/// Norm of (u - exact) over that of exact, both in L2.
double l2_error(const mesh::TetMesh& mesh, std::span<const Vec3> positions, double amplitude) {
    double wrong = 0;
    double whole = 0;
    for (const auto& [b, weight] : tet_points()) {
        const auto shape = mesh::shape_functions(mesh.order, b);
        for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
            const auto nodes = mesh.tet(t);
            Vec3 X, x;
            for (std::size_t a = 0; a < nodes.size(); ++a) {
                X += shape[a] * mesh.points[static_cast<std::size_t>(nodes[a])];
                x += shape[a] * positions[static_cast<std::size_t>(nodes[a])];
            }
            const Vec3 exact = amplitude * harmonic_gradient(X);
            const Vec3 e = x - X - exact;
            wrong += weight * dot(e, e);
            whole += weight * dot(exact, exact);
        }
    }
    return std::sqrt(wrong / whole);
}

/// log2 of the ratio of the errors on the last two of three meshes, each twice as fine as the one before.
double measured_order(int order, double nu, std::array<int, 3> cells) {
    const double amplitude = 1e-5;  // small enough for the difference between neo-Hooke and Hooke to vanish
    std::array<double, 3> error{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto outside = [](Vec3 p) { return on_side(p, 0) || on_side(p, 1) || on_side(p, 2); };
        const Description d = cube(order, cells[k], material::neo_hookean(1e6, nu), outside,
                                   [&](Vec3 p) { return amplitude * harmonic_gradient(p); });
        error[k] = l2_error(d.mesh, equilibrium_of(d, 1, 1e-6).steps.back().positions, amplitude);
    }
    MESSAGE("order " << order << ", nu " << nu << ": errors " << error[0] << " " << error[1] << " " << error[2]
                     << ", measured orders " << std::log2(error[0] / error[1]) << " "
                     << std::log2(error[1] / error[2]));
    return std::log2(error[1] / error[2]);
}

}  // namespace

TEST_CASE("uniaxial stretch of a block agrees with the closed form, every law") {
    for (const PrincipalForm& form : reference::principal_forms()) {
        for (const double stretch : {0.8, 1.4}) {
            const double side = reference::free_stretch(form, [&](double l) { return std::array{stretch, l, l}; });
            check_stretch(form, {stretch, side, side}, 1);
        }
    }
}

TEST_CASE("equibiaxial stretch of a block agrees with the closed form, every law") {
    for (const PrincipalForm& form : reference::principal_forms()) {
        const double stretch = 1.25;
        const double side = reference::free_stretch(form, [&](double l) { return std::array{stretch, stretch, l}; });
        check_stretch(form, {stretch, stretch, side}, 2);
    }
}

TEST_CASE("simple shear of a block agrees with the closed form, every law") {
    for (const PrincipalForm& form : reference::principal_forms()) check_shear(form, 0.5);
}

TEST_CASE("a slender beam under a small load deflects as Euler and Bernoulli say") {
    const double L = 0.1, h = 0.005, E = 12e6, force = 1e-4;
    for (const double nu : {0.0, 0.3, 0.45}) {
        CAPTURE(nu);
        Description d;
        d.mesh = mesh::to_quadratic(kuhn_box({L, h, h}, 40, 2, 2, [](Vec3) { return 0; }));
        d.materials = {{"A", material::neo_hookean(E, nu), 0}};
        d.material_of_region = {0};
        d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < tiny; }), {}}};
        std::vector<mesh::Face> faces;
        for (const mesh::Face& f : mesh::boundary_faces(d.mesh)) {
            const auto& p = d.mesh.points;
            if (p[f.nodes[0]].x + p[f.nodes[1]].x + p[f.nodes[2]].x > 3 * L - tiny) faces.push_back(f);
        }
        const SurfaceShares shares = surface_shares(d.mesh, faces);
        d.loads = {{"tip", shares.nodes, shares.shares, {0, 0, force}}};
        d.markers = {
            {"tip", reference::mean_of(reference::nodes_where(d.mesh, [&](Vec3 p) { return p.x > L - tiny; }))}};
        const double tip = equilibrium_of(d, 1, 1e-5).steps.back().markers[0].position_m.z - h / 2;
        const double bending = force * L * L * L / (3 * E * h * h * h * h / 12);
        // Timoshenko's shear term: a square section's shear coefficient is 5/6 (at nu = 0).
        const double shear = force * L / (5.0 / 6 * E / (2 * (1 + nu)) * h * h);
        MESSAGE("tip over Euler-Bernoulli's: " << tip / bending << " with shear: " << tip / (bending + shear));
        // The clamp keeps its section from contracting, which stiffens the root by the order of nu^2 h / L.
        CHECK(tip == near(bending, {.relative = 0.005 + nu * nu * h / L}));
    }
}

TEST_CASE("displacements converge with order 2 on linear and order 3 on quadratic tets") {
    CHECK(measured_order(1, 0.3, {4, 8, 16}) == near(2, {.relative = 0.1}));
    CHECK(measured_order(2, 0.3, {2, 4, 8}) == near(3, {.relative = 0.1}));
}
