// What must hold at every step of examples/gripper_holds_a_ball, on any mesh; here on linear tets, which are quick. The
// example's own numbers are in its expected.json.
#include <doctest/doctest.h>

#include <cmath>

#include "robot/file/robot_file.hpp"
#include "simulation/run/fields.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;

namespace {

struct Grip {
    sim::Model model;
    sim::Trajectory result;
};

Grip run(std::vector<std::string> assignments) {
    assignments.emplace_back("mesh.order=1");
    robot::testing::Built gripper =
        robot::testing::build(robot::load_robot("examples/gripper_holds_a_ball/robot.toml", assignments));
    sim::Trajectory result = robot::testing::run_to_the_end(gripper);
    return {std::move(gripper.model), std::move(result)};
}

/// The pull that the ball needs: its force on the gripper, downwards.
double pull_N(const sim::Step& step) {
    return -step.contacts.at(0).force_N.z;
}

}  // namespace

TEST_CASE("friction holds the ball, nothing crosses, and the arm carries the pull of the ball") {
    const Grip rough = run({}), smooth = run({"parameters.friction=0"});
    for (const sim::Step& step : rough.result.steps) {
        const auto x = sim::contact_nodes(rough.model, step.positions, step.time);
        CHECK_FALSE(rough.model.contact(true)->crossing(x).has_value());
        // The cables ride on the gripper with both ends: only ball and arm act on it from outside.
        const Vec3 ball = step.contacts.at(0).force_N, arm = step.supports.at(0).force_N;
        CHECK(norm(ball + arm) < 1e-2 * norm(ball) + 1e-3);
    }
    const sim::Step& last = rough.result.steps.back();
    CHECK(last.smallest_distance_m > -0.1e-3);  // pressed a little into the ball as drawn, never through it
    CHECK(last.smallest_distance_m < 0.4e-3);
    CHECK(pull_N(last) > 1);
    CHECK(std::abs(pull_N(smooth.result.steps.back())) < 0.5 * pull_N(last));

    const auto pressure = sim::contact_pressure(rough.model, last);
    int pressed = 0;
    for (std::size_t n = 0; n < pressure.size(); ++n) {
        if (pressure[n] == 0) continue;
        ++pressed;
        // Only inner sides are touched: nearer to the axis than the middle of a finger.
        CHECK(std::hypot(last.positions[n].x, last.positions[n].y) < 17e-3);
    }
    CHECK(pressed >= 3);
    const auto rest = sim::contact_pressure(rough.model, rough.result.steps.front());
    for (const double p : rest) CHECK(p == 0);
}
