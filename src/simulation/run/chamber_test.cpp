// Chambers: geometry of the wall by finite differences, and the same answer however the air is driven.
#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "base/core/near.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/actuators/chamber_surface.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using testing::block_side;
using testing::hollow_block;
using testing::solve;

namespace {

/// Rest positions with a smooth and a rough distortion.
std::vector<double> distorted(const mesh::TetMesh& mesh) {
    std::vector<double> x;
    for (const Vec3& p : mesh.points) {
        const double s = 1e-3 * std::sin(517 * p.x + 911 * p.y - 1300 * p.z);
        x.insert(x.end(), {p.x + s, p.y + 0.1 * p.x + 0.5 * s, p.z * 1.1 - 0.7 * s});
    }
    return x;
}

/// One rough direction.
std::vector<double> direction_of(std::size_t size) {
    std::vector<double> direction(size);
    for (std::size_t i = 0; i < size; ++i) direction[i] = std::cos(12.9898 * static_cast<double>(i));
    return direction;
}

std::vector<double> moved(std::vector<double> x, const std::vector<double>& direction, double h) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += h * direction[i];
    return x;
}

std::vector<double> gradient_of(const ChamberSurface& wall, const std::vector<double>& x) {
    std::vector<double> gradient(x.size(), 0.0);
    wall.add_gradient(x, 1, gradient);
    return gradient;
}

/// The symmetric part of the second gradient, times a direction.
std::vector<double> hessian_times(const ChamberSurface& wall, const std::vector<double>& x,
                                  const std::vector<double>& direction) {
    std::vector<int> free_index(x.size() / 3);
    std::iota(free_index.begin(), free_index.end(), 0);
    linalg::Lists cliques;
    wall.append_cliques(free_index, cliques);
    const auto pattern = linalg::make_pattern(static_cast<int>(free_index.size()), 3, cliques);
    std::vector<double> hessian(pattern.entries(), 0.0);
    wall.add_hessian(x, 1, free_index, pattern, hessian, false);
    std::vector<double> product(x.size(), 0.0);
    linalg::add_product(pattern, hessian, direction, 1, product);
    return product;
}

/// The gradient's slope along a direction, by central differences; the volume is a cubic, so that they are exact but
/// for rounding.
std::vector<double> gradient_slope(const ChamberSurface& wall, const std::vector<double>& x,
                                   const std::vector<double>& direction) {
    const double h = 1e-5;
    std::vector<double> slope = gradient_of(wall, moved(x, direction, h));
    const std::vector<double> behind = gradient_of(wall, moved(x, direction, -h));
    for (std::size_t i = 0; i < x.size(); ++i) slope[i] = (slope[i] - behind[i]) / (2 * h);
    return slope;
}

double largest(const std::vector<double>& values) {
    double most = 0;
    for (const double value : values) most = std::max(most, std::fabs(value));
    return most;
}

}  // namespace

TEST_CASE("the wall of a chamber: volume, gradient and Hessian agree with finite differences") {
    for (const int order : {1, 2}) {
        const Description d = hollow_block(order);
        std::vector<double> rest;
        for (const Vec3& p : d.mesh.points) rest.insert(rest.end(), {p.x, p.y, p.z});
        const ChamberSurface wall(d.chambers[0].wall, rest);
        CHECK(is_closed(d.chambers[0].wall));
        CHECK(wall.volume(rest) == near(0.02 * 0.005 * 0.005, {.relative = 1e-12}));

        const std::vector<double> x = distorted(d.mesh);
        const std::vector<double> direction = direction_of(x.size());
        const std::vector<double> gradient = gradient_of(wall, x);
        double slope = 0;
        for (std::size_t i = 0; i < x.size(); ++i) slope += gradient[i] * direction[i];
        const double h = 1e-5;
        const double rise = wall.volume(moved(x, direction, h)) - wall.volume(moved(x, direction, -h));
        CHECK(rise / (2 * h) == near(slope, {.relative = 1e-9}));
        const std::vector<double> expected = gradient_slope(wall, x, direction);
        CHECK(largest(moved(hessian_times(wall, x, direction), expected, -1)) < 1e-8 * largest(expected));
    }
}

TEST_CASE("an open wall: symmetric and skew parts sum to the derivative of the follower force") {
    const Description d = hollow_block(2);
    Wall wall = d.chambers[0].wall;
    wall.faces.resize(wall.faces.size() / 3);
    REQUIRE_FALSE(is_closed(wall));
    const std::vector<double> x = distorted(d.mesh);
    const ChamberSurface surface(wall, x);
    const std::vector<double> direction = direction_of(x.size());
    std::vector<double> skew(x.size(), 0.0);
    surface.apply_skew(x, 1, direction, skew);
    const std::vector<double> expected = gradient_slope(surface, x, direction);
    const std::vector<double> both = moved(hessian_times(surface, x, direction), skew, 1);
    CHECK(largest(moved(both, expected, -1)) < 1e-8 * largest(expected));
    CHECK(largest(skew) > 1e-2 * largest(expected));
}

TEST_CASE("driving a chamber by volume, pressure or gas reaches the same state") {
    for (const int order : {1, 2}) {
        Description d = hollow_block(order);
        d.chambers[0].target = {ChamberTarget::Kind::volume_ratio, 1.6};
        const Trajectory by_volume = solve(d, {.steps = 4, .tolerance = 1e-8});
        REQUIRE_MESSAGE(by_volume.converged, by_volume.message);
        const ChamberState air = by_volume.steps.back().chambers[0];
        CHECK(air.volume_ratio == near(1.6, {.relative = 1e-9}));
        CHECK(air.pressure_Pa > 1000);

        d.chambers[0].target = {ChamberTarget::Kind::pressure_Pa, air.pressure_Pa};
        const Trajectory by_pressure = solve(d, {.steps = 4, .tolerance = 1e-8});
        REQUIRE_MESSAGE(by_pressure.converged, by_pressure.message);
        CHECK(by_pressure.steps.back().chambers[0].volume_ratio == near(1.6, {.relative = 1e-6}));

        const double gas = 1.6 * (air.pressure_Pa + d.ambient_pressure_Pa) / d.ambient_pressure_Pa;
        d.chambers[0].target = {ChamberTarget::Kind::gas_ratio, gas};
        const Trajectory by_gas = solve(d, {.steps = 4, .tolerance = 1e-8});
        REQUIRE_MESSAGE(by_gas.converged, by_gas.message);
        CHECK(by_gas.steps.back().chambers[0].volume_ratio == near(1.6, {.relative = 1e-6}));
        CHECK(by_gas.steps.back().chambers[0].pressure_Pa == near(air.pressure_Pa, {.relative = 1e-6}));
    }
}

TEST_CASE("every solver inflates and deflates a chamber") {
    for (const Solver solver : {Solver::newton, Solver::quasi_newton, Solver::anderson, Solver::local_global}) {
        for (const double ratio : {1.4, 0.7}) {
            Description d = hollow_block(1);
            d.chambers[0].target = {ChamberTarget::Kind::volume_ratio, ratio};
            const Trajectory result = solve(d, {.steps = 4, .tolerance = 1e-5, .solver = solver});
            CAPTURE(result.solver);
            CAPTURE(ratio);
            REQUIRE_MESSAGE(result.converged, result.message);
            CHECK(result.steps.back().chambers[0].volume_ratio == near(ratio, {.relative = 1e-6}));
            CHECK((result.steps.back().chambers[0].pressure_Pa > 0) == (ratio > 1));
        }
    }
}

TEST_CASE("a sealed chamber stiffens the block around it") {
    // Push at the far end: the chamber shrinks, its gas pushes back.
    Description d = hollow_block(2);
    d.supports.push_back({"grip",
                          reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 3 * block_side - 1e-9; }),
                          {-0.3 * block_side, 0, 0}});
    d.chambers[0].target = {ChamberTarget::Kind::gas_ratio, 1};
    const Trajectory sealed = solve(d, {.steps = 3, .tolerance = 1e-7});
    REQUIRE_MESSAGE(sealed.converged, sealed.message);
    const ChamberState air = sealed.steps.back().chambers[0];
    CHECK((air.pressure_Pa + d.ambient_pressure_Pa) * air.volume_m3 ==
          near(d.ambient_pressure_Pa * 0.02 * 0.005 * 0.005, {.relative = 1e-9}));
    d.chambers.clear();
    const Trajectory open = solve(d, {.steps = 3, .tolerance = 1e-7});
    REQUIRE(open.converged);
    CHECK(air.pressure_Pa > 0);
    CHECK(std::fabs(sealed.steps.back().supports[1].force_N.x) > std::fabs(open.steps.back().supports[1].force_N.x));
}

TEST_CASE("a pressure on the outer surface follows it, and its sum is the support's force") {
    Description d = hollow_block(2);
    d.chambers.clear();
    std::vector<mesh::Face> faces;
    for (const mesh::Face& face : mesh::boundary_faces(d.mesh)) {
        const auto on_top = [&](int node) { return d.mesh.points[node].z > block_side - 1e-9; };
        if (on_top(face.nodes[0]) && on_top(face.nodes[1]) && on_top(face.nodes[2])) {
            mesh::Face turned = face;  // seen from the solid side: out of the air
            std::swap(turned.nodes[1], turned.nodes[2]);
            std::swap(turned.nodes[3], turned.nodes[5]);
            faces.push_back(turned);
        }
    }
    std::vector<int> same(d.mesh.points.size());
    std::iota(same.begin(), same.end(), 0);
    const double pressure = 300;
    d.pressures = {{"press", wall_of_faces(d.mesh, faces, same), pressure}};
    const Trajectory result = solve(d, {.steps = 3, .tolerance = 1e-8});
    REQUIRE_MESSAGE(result.converged, result.message);
    const Vec3 force = result.steps.back().supports[0].force_N;
    // Little bending: the top presses down with pressure times area, to the order of the rotation.
    CHECK(force.z == near(pressure * 3 * block_side * block_side, {.relative = 0.1}));
    CHECK(result.steps.back().markers[0].position_m.z < 0.5 * block_side - 1e-4);
    // Four times the pressure: the surface turns and carries the force with it.
    d.pressures[0].pressure_Pa = 4 * pressure;
    const Trajectory strong = solve(d, {.steps = 10, .tolerance = 1e-8});
    REQUIRE_MESSAGE(strong.converged, strong.message);
    CHECK(strong.steps.back().supports[0].force_N.x > 0.05 * strong.steps.back().supports[0].force_N.z);
}

TEST_CASE("suction on a patch with a free rim of an arch converges up to its target") {
    // The symmetric part of its tangent is indefinite. With the projected tangent instead, Newton's method needed ten
    // to sixty iterations a step of the program, and stopped before half of this suction was reached.
    constexpr double span = 0.1, rise = 0.02, thick = 0.003;
    const double radius = (span * span / 4 + rise * rise) / (2 * rise), half = std::asin(span / 2 / radius);
    Description d;
    d.mesh = mesh::to_quadratic(reference::kuhn_box({span, 0.01, thick}, 20, 1, 1, [](Vec3) { return 0; }));
    d.supports = {{"ends", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9 || p.x > span - 1e-9; }), {}}};
    std::vector<mesh::Face> faces;
    for (mesh::Face face : mesh::boundary_faces(d.mesh)) {
        const auto on_top = [&](int node) { return d.mesh.points[node].z > thick - 1e-9; };
        if (!on_top(face.nodes[0]) || !on_top(face.nodes[1]) || !on_top(face.nodes[2])) continue;
        std::swap(face.nodes[1], face.nodes[2]);
        std::swap(face.nodes[3], face.nodes[5]);
        faces.push_back(face);
    }
    for (Vec3& p : d.mesh.points) {
        const double angle = half * (2 * p.x / span - 1), r = radius + p.z - thick / 2;
        p = {span / 2 + r * std::sin(angle), p.y, r * std::cos(angle) - radius + rise};
    }
    d.materials = {{"A", material::neo_hookean(1e6, 0.45), 1000}};
    d.material_of_region = {0};
    std::vector<int> same(d.mesh.points.size());
    std::iota(same.begin(), same.end(), 0);
    d.pressures = {{"suck", wall_of_faces(d.mesh, faces, same), -60e3}};
    const auto top = reference::nodes_where(d.mesh, [&](Vec3 p) { return std::fabs(p.x - span / 2) < 1e-9; });
    d.markers = {{"top", reference::mean_of(top)}};
    const Trajectory result = solve(d, {.steps = 20});
    REQUIRE_MESSAGE(result.converged, result.message);
    int iterations = 0;
    for (const Step& step : result.steps) iterations += step.iterations;
    CHECK_MESSAGE(iterations < 300, iterations);
    // With six times as many tets it is 104.03 mm.
    CHECK(result.steps.back().markers[0].position_m.z == near(0.1040, {.relative = 0.01}));
}

TEST_CASE("a chamber that collapses stops the run with a message, and the last good step is kept") {
    Description d = hollow_block(1);
    d.chambers[0].target = {ChamberTarget::Kind::pressure_Pa, -1e6, {}};
    const Trajectory result = solve(d, {.steps = 10});
    CHECK_FALSE(result.converged);
    CHECK(result.message.find("leaves a chamber without volume") != std::string::npos);
    for (const Step& step : result.steps) CHECK(step.chambers[0].volume_m3 > 0);
}

TEST_CASE("a chamber that would have to pull harder than a vacuum is named") {
    Description d = hollow_block(1);
    d.chambers[0].target = {ChamberTarget::Kind::volume_ratio, 0.7};
    const Trajectory possible = solve(d, {.steps = 4});
    REQUIRE_MESSAGE(possible.converged, possible.message);
    CHECK(possible.warnings.empty());
    const double lowest = possible.steps.back().chambers[0].pressure_Pa;
    d.ambient_pressure_Pa = -0.9 * lowest;
    const Trajectory impossible = solve(d, {.steps = 4});
    REQUIRE(impossible.warnings.size() == 1);
    CHECK(impossible.warnings[0].starts_with("from step 4 on the pressure in chamber \"" + d.chambers[0].name +
                                             "\" is below a vacuum"));
}

TEST_CASE("a chamber with an open wall is refused") {
    Description d = hollow_block(1);
    d.chambers[0].wall.faces.pop_back();
    const auto model = Model::create(std::move(d));
    REQUIRE_FALSE(model);
    CHECK(model.error().message.find("not closed") != std::string::npos);
}
