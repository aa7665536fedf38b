#include "simulation/model/held_nodes.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "simulation/actuators/loads.hpp"
#include "simulation/peers/principal_forms.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using pliant::test::holds;
using reference::kuhn_box;
using reference::nodes_where;

namespace {

constexpr double side = 0.01, tiny = 1e-9;

std::vector<int> plane_nodes(const mesh::TetMesh& mesh, std::size_t axis, double at) {
    return nodes_where(mesh, [=](Vec3 p) { return std::fabs(p[axis] - at) < tiny; });
}

Vec3 axis_vector(std::size_t axis, double length = 1) {
    Vec3 v;
    v[axis] = length;
    return v;
}

Support roller(const char* name, const mesh::TetMesh& mesh, std::size_t axis, double at, double move = 0) {
    Support support{name, plane_nodes(mesh, axis, at), axis_vector(axis, move)};
    support.directions = {axis_vector(axis)};
    return support;
}

/// An eighth of a block under tension: three planes of symmetry, and an end that is drawn out by `stretch`.
Description eighth(int order, double stretch) {
    Description d;
    d.mesh = kuhn_box({side, side, side}, 2, 2, 2, [](Vec3) { return 0; });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"A", material::neo_hookean(1e5, 0.4), 1000}};
    d.material_of_region = {0};
    d.supports = {roller("x", d.mesh, 0, 0), roller("y", d.mesh, 1, 0), roller("z", d.mesh, 2, 0),
                  roller("end", d.mesh, 0, side, (stretch - 1) * side)};
    return d;
}

/// The same problem turned in space.
Description turned(Description d, const Eigen::Matrix3d& R) {
    const auto turn = [&](Vec3& v) {
        const Eigen::Vector3d w = R * Eigen::Vector3d(v.x, v.y, v.z);
        v = {w[0], w[1], w[2]};
    };
    for (Vec3& p : d.mesh.points) turn(p);
    for (Support& support : d.supports) {
        turn(support.move_m);
        for (Vec3& direction : support.directions) turn(direction);
    }
    return d;
}

void check_uniaxial(const Description& d, Solver solver, double stretch) {
    const Trajectory result = testing::solve(d, {.steps = 2, .tolerance = 1e-7, .solver = solver});
    REQUIRE_MESSAGE(result.converged, result.message);
    const reference::PrincipalForm form = reference::principal_form(d.materials[0].law);
    const double lateral = reference::free_stretch(form, [=](double l) { return std::array{stretch, l, l}; });
    const double force = side * side * form.stress({stretch, lateral, lateral}).x;
    const Step& last = result.steps.back();
    CHECK(norm(last.supports[3].force_N) == near(force, {.relative = 1e-6}));
    CHECK(norm(last.supports[0].force_N + last.supports[3].force_N) < 1e-5 * force);
    CHECK(norm(last.supports[1].force_N) < 1e-5 * force);
    // Every point moves in proportion: along the pull, and across it.
    const Vec3 pull = unit(d.supports[3].directions[0]);
    for (std::size_t n = 0; n < last.positions.size(); ++n) {
        const Vec3 X = d.mesh.points[n];
        const double along = dot(pull, X);
        CHECK(norm(last.positions[n] - (stretch * along * pull + lateral * (X - along * pull))) < 1e-6 * side);
    }
}

}  // namespace

TEST_CASE("an eighth of a block with three planes of symmetry stretches as the law says, with every solver") {
    constexpr double stretch = 1.4;
    for (const int order : {1, 2}) {
        for (const Solver solver : {Solver::newton, Solver::quasi_newton, Solver::anderson}) {
            CAPTURE(order);
            CAPTURE(name(solver));
            check_uniaxial(eighth(order, stretch), solver, stretch);
        }
    }
}

TEST_CASE("held directions need not be axes: the rotated block gives the same force") {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
    check_uniaxial(turned(eighth(2, 1.3), R), Solver::newton, 1.3);
}

TEST_CASE("half a bent beam with a plane of symmetry equals half of the whole beam") {
    const auto beam = [](bool half) {
        Description d;
        const double width = half ? 0.5 * side : side;
        d.mesh = mesh::to_quadratic(kuhn_box({6 * side, width, side}, 12, half ? 2 : 4, 4, [](Vec3) { return 0; }));
        d.materials = {{"A", material::neo_hookean(1e5, 0.45), 1000}};
        d.material_of_region = {0};
        d.supports = {{"clamp", plane_nodes(d.mesh, 0, 0), {}}};
        if (half) d.supports.push_back(roller("middle", d.mesh, 1, width));
        std::vector<mesh::Face> end;
        for (const mesh::Face& face : mesh::boundary_faces(d.mesh)) {
            const bool at_end = std::all_of(face.nodes.begin(), face.nodes.begin() + 3, [&](int n) {
                return d.mesh.points[static_cast<std::size_t>(n)].x > 6 * side - tiny;
            });
            if (at_end) end.push_back(face);
        }
        SurfaceShares shares = surface_shares(d.mesh, end);
        d.loads = {{"push", std::move(shares.nodes), std::move(shares.shares), {0, 0, half ? 0.02 : 0.04}}};
        const int corner = nodes_where(d.mesh, [](Vec3 p) { return norm(p - Vec3{6 * side, 0, 0}) < tiny; }).at(0);
        d.markers = {{"tip", {{corner}, {1.0}, {}}}};
        return testing::solve(std::move(d), {.steps = 2, .tolerance = 1e-8});
    };
    const Trajectory whole = beam(false), half = beam(true);
    REQUIRE(whole.converged);
    REQUIRE(half.converged);
    const Vec3 tip = whole.steps.back().markers[0].position_m;
    CHECK(tip.z > 2 * side);
    CHECK(norm(half.steps.back().markers[0].position_m - tip) < 1e-6 * side);
}

TEST_CASE("a body in a frictionless slot slides along it until a spring balances the load") {
    // Held in y and z everywhere on one face, free along x but for a spring: the spring must balance the load.
    Description d = eighth(1, 1);
    d.supports = {{"slot", plane_nodes(d.mesh, 1, 0), {}}};
    d.supports[0].directions = {{0, 1, 0}, {0, 0, 1}, {0, 2, 2}};  // the third says nothing new
    d.springs = {
        {"spring", {reference::mean_of(plane_nodes(d.mesh, 0, 0)), {{}, {}, {-side, side / 2, side / 2}}}, 10}};
    const std::vector<int> face = plane_nodes(d.mesh, 1, 0);
    d.loads = {{"push", face, std::vector<double>(face.size(), 1.0 / static_cast<double>(face.size())), {0.01, 0, 0}}};
    const Trajectory result = testing::solve(std::move(d), {.steps = 1, .tolerance = 1e-8});
    REQUIRE_MESSAGE(result.converged, result.message);
    CHECK(result.steps.back().springs[0].force_N == near(0.01, {.relative = 1e-6}));
    CHECK(result.steps.back().springs[0].length_m == near(side + 0.001, {.relative = 1e-6}));
    CHECK(std::fabs(result.steps.back().supports[0].force_N.x) < 1e-12);
}

TEST_CASE("supports that contradict each other are named") {
    const auto message = [](Description d) {
        const auto model = Model::create(std::move(d));
        return model ? std::string() : model.error().message;
    };
    Description d = eighth(1, 1.2);
    CHECK(message(d).empty());
    Description twice = d;
    twice.supports.push_back(roller("again", d.mesh, 0, side, 0.5 * side));
    CHECK_MESSAGE(holds(message(twice), "fixed \"end\" and fixed \"again\" hold the same nodes in the same direction"),
                  message(twice));
    Description still = d;
    still.supports.push_back(roller("again", d.mesh, 1, 0));
    CHECK_MESSAGE(message(still).empty(), message(still));  // neither moves: they agree
    Description clamps = d;
    clamps.supports = {{"a", plane_nodes(d.mesh, 0, 0), {}}, {"b", plane_nodes(d.mesh, 1, 0), {}}};
    CHECK(holds(message(clamps), "share nodes"));
    Description zero = d;
    zero.supports[0].directions = {{0, 0, 0}};
    CHECK(holds(message(zero), "fixed \"x\": a direction must not be zero"));
}
