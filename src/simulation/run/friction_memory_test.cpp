// Surfaces that stick stay in place, however many steps a program has; sliding ones drag their anchor along.
#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using testing::solve;

namespace {

constexpr double cube_side = 0.01;

/// A cube of rubber on a clamp. A plane is pressed on it in the first tenth of the program; then its top is pushed
/// sideways, until three tenths of the program are over.
Description pressed_cube(double friction, double push_N) {
    Description d;
    d.mesh = reference::kuhn_box({cube_side, cube_side, cube_side}, 3, 3, 3, [](Vec3) { return 0; });
    d.materials = {{"rubber", material::neo_hookean(1e5, 0.3), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.z < 1e-9; }), {}}};
    const std::vector<int> top = reference::nodes_where(d.mesh, [](Vec3 p) { return p.z > cube_side - 1e-9; });
    const double share = 1.0 / static_cast<double>(top.size());
    d.loads = {
        {"push", top, std::vector<double>(top.size(), share), {push_N, 0, 0}, Curve{{0, 0.1, 0.3, 1}, {0, 0, 1, 1}}}};
    d.contact =
        ContactRules{contact::robot_surface(d.mesh), {.distance_m = 1e-4, .stiffness_Pa = 1e4, .slip_m = 1e-5}, {}};
    d.contact->obstacles.push_back({{"press", contact::HalfSpace{{0, 0, cube_side + 1e-4}, {0, 0, -1}}, friction},
                                    {0, 0, -1e-3},
                                    Curve{{0, 0.1, 1}, {0, 1, 1}}});
    d.markers = {{"top", reference::mean_of(top)}};
    return d;
}

}  // namespace

TEST_CASE("a cube held by friction does not creep, in any number of steps") {
    const Trajectory t = solve(pressed_cube(0.5, 0.3), {.steps = 60, .tolerance = 1e-7});
    REQUIRE_MESSAGE(t.converged, t.message);
    // Held by the rubber alone the top would go far; held by friction it goes a part of the slip, and then stays.
    const double free = t.steps[18].markers[0].position_m.x;
    const Trajectory smooth = solve(pressed_cube(0, 0.3), {.steps = 10});
    REQUIRE(smooth.converged);
    const double sheared = smooth.steps.back().markers[0].position_m.x - cube_side / 2;
    CHECK(free - cube_side / 2 < 0.1 * sheared);
    const double drift = std::abs(t.steps[60].markers[0].position_m.x - t.steps[18].markers[0].position_m.x);
    MESSAGE("drift in 42 steps: ", drift, " m, sheared without friction ", sheared, " m");
    CHECK(drift < 1e-3 * 1e-5);  // of the slip
}

TEST_CASE("when the load reverses, friction reverses within twice the slip that counts as sticking") {
    // Pushed hard enough to slide, then let go: friction turns round within twice the slip.
    Description d = pressed_cube(0.2, 1.2);
    d.loads[0].share = Curve{{0, 0.1, 0.5, 1}, {0, 0, 1, 0}};
    const Trajectory t = solve(d, {.steps = 60, .tolerance = 1e-6});
    REQUIRE_MESSAGE(t.converged, t.message);
    const auto friction = [&](std::size_t k) {
        return t.steps[k].contacts[0].force_N.x / std::abs(t.steps[k].contacts[0].force_N.z);
    };
    CHECK(friction(30) == near(-0.2, {.relative = 1e-3}));  // it slides to the right
    CHECK(friction(60) == near(0.2, {.relative = 1e-3}));   // and back
}
