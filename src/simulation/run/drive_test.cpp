// Inputs one after the other, as in the studio, the workspace and policies.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <limits>
#include <utility>
#include <vector>

#include "base/core/near.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/stepper/stepper.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

/// A bar of 60 x 10 x 10 mm, clamped at x = 0, with cables along it at these depths and heights.
Model bar_with_cables(const std::vector<std::pair<double, double>>& places) {
    Description d;
    d.mesh = reference::kuhn_box({0.06, 0.01, 0.01}, 12, 2, 2, [](Vec3) { return 0; });
    d.materials = {{"A", material::neo_hookean(1e6, 0.45), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    const Attacher attacher(d.mesh);
    for (const auto& [y, z] : places) {
        Cable cable{fmt::format("at {} {}", y, z), {}, {CableTarget::Kind::length_ratio, 1}};
        for (int k = 0; k <= 4; ++k) cable.points.push_back(*attacher.carried_by_tet({0.015 * k, y, z}, 1e-6));
        d.cables.push_back(std::move(cable));
    }
    auto model = Model::create(std::move(d));
    REQUIRE(model.has_value());
    return *std::move(model);
}

Model bar_with_cable_above() {
    return bar_with_cables({{0.005, 0.009}});
}

/// The cable at this share of its length.
StepReport pull(Stepper& stepper, RobotState& robot, double ratio) {
    Inputs wanted = robot.inputs;
    wanted.drives[0] = {Drive::Kind::measure, ratio * 0.06};
    StepReport report = stepper.drive(robot, wanted, {});
    REQUIRE(report.arrived);
    REQUIRE(robot.x().allFinite());
    REQUIRE(robot.now.state.multiplier.allFinite());
    return report;
}

}  // namespace

TEST_CASE("equal pulls one after the other are extrapolated from all states behind") {
    const Model model = bar_with_cable_above();
    Stepper stepper(model, {.tolerance = 1e-8});
    RobotState robot = stepper.rest();
    int first = 0, last = 0;
    for (int k = 1; k <= 6; ++k) {
        last = pull(stepper, robot, 1 - 0.02 * k).iterations;
        if (k == 2) first = last;
    }
    CHECK(last < first);
    REQUIRE(robot.past.size() == 3);
    for (std::size_t k = 0; k < 3; ++k)
        CHECK(robot.past[k].along == near(static_cast<double>(k) - 2, {.absolute = 1e-9}));
    CHECK(robot.now.along == 1);
}

TEST_CASE("after a reversal, and on the way back and forth, the states are those of single pulls") {
    const Model model = bar_with_cable_above();
    Stepper stepper(model, {.tolerance = 1e-8});
    const auto alone = [&](double ratio) {
        RobotState robot = stepper.rest();
        pull(stepper, robot, ratio);
        return robot;
    };
    RobotState robot = stepper.rest();
    for (const double ratio : {0.98, 0.96, 0.94, 0.96, 0.98, 0.96, 0.94, 0.92, 0.94, 0.96, 0.9, 0.96}) {
        CAPTURE(ratio);
        pull(stepper, robot, ratio);
        const RobotState expected = alone(ratio);
        CHECK((robot.x() - expected.x()).norm() < 1e-6 * expected.x().norm());
        CHECK(robot.now.state.multiplier[0] == near(expected.now.state.multiplier[0], {.relative = 1e-4}));
    }
}

TEST_CASE("cables that are driven by length and by tension in turn: the states are those of single pulls") {
    const Model model = bar_with_cables({{0.005, 0.009}, {0.001, 0.005}, {0.009, 0.005}});
    Stepper stepper(model, {.tolerance = 1e-8});
    const auto by_length = [](double ratio) { return Drive{Drive::Kind::measure, ratio * 0.06}; };
    const auto by_tension = [](double tension_N) { return Drive{Drive::Kind::multiplier, tension_N}; };
    // Small changes, so that a factor is used again, with other constraints each time.
    const std::vector<std::vector<Drive>> pulls = {
        {by_length(0.97), by_length(0.98), by_length(0.99)},   {by_length(0.969), by_tension(1), by_length(0.989)},
        {by_tension(4), by_tension(1.01), by_length(0.989)},   {by_length(0.968), by_length(0.979), by_tension(0.5)},
        {by_length(0.967), by_length(0.979), by_length(0.99)}, {by_tension(4), by_length(0.979), by_length(0.99)}};
    RobotState robot = stepper.rest();
    for (std::size_t k = 0; k < pulls.size(); ++k) {
        CAPTURE(k);
        Inputs wanted = robot.inputs;
        wanted.drives = pulls[k];
        REQUIRE(stepper.drive(robot, wanted, {}).arrived);
        RobotState alone = stepper.rest();
        REQUIRE(stepper.drive(alone, wanted, {}).arrived);
        CHECK((robot.x() - alone.x()).norm() < 1e-6 * alone.x().norm());
        for (Eigen::Index c = 0; c < 3; ++c)
            CHECK(robot.now.state.multiplier[c] ==
                  near(alone.now.state.multiplier[c], {.relative = 1e-4, .absolute = 1e-6}));
    }
}

TEST_CASE("a state that is not a number is far from equilibrium") {
    const Model model = bar_with_cable_above();
    Stepper stepper(model, {.tolerance = 1e-8});
    RobotState robot = stepper.rest();
    pull(stepper, robot, 0.98);
    State state = robot.now.state;
    CHECK(stepper.system().evaluate(state, robot.controls).error() < 1e-7);
    state.multiplier[0] = std::numeric_limits<double>::quiet_NaN();
    CHECK(stepper.system().evaluate(state, robot.controls).error() > 1);
}
