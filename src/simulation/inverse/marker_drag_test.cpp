// Dragging a marker, as in the studio.
#include "simulation/inverse/marker_drag.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "simulation/inverse/test_robots.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::inverse;
using namespace pliant::sim::inverse::testing;

namespace {

const std::vector<std::pair<double, double>> four(4, {0.7, 1});

Vec3 tip(const Model& model, const RobotState& robot) {
    return position(model.description().markers[0].point,
                    {robot.x().data(), static_cast<std::size_t>(robot.x().size())});
}

/// Leads until it is settled; counts the pieces.
Led lead_to(MarkerDrag& drag, RobotState& robot, const Vec3& wanted, int& pieces) {
    for (pieces = 1; pieces < 100; ++pieces) {
        const Led led = drag.lead(robot, wanted, {});
        if (led.settled) return led;
    }
    FAIL("it never settles");
    return {};
}

}  // namespace

TEST_CASE("the tip follows the pointer in limited steps, and back again") {
    const Model model = made(bar(4));
    const InverseTask task = task_for(model, four);
    const Vec3 wanted = tip_under(model, task, {0.8, 1, 0.9, 1});
    Stepper stepper(model, tight);
    MarkerDrag drag(stepper, task.inputs, 0);
    RobotState robot = stepper.rest();
    const Vec3 rest = tip(model, robot);
    int pieces = 0;
    const Led there = lead_to(drag, robot, wanted, pieces);
    CHECK(there.reached);
    CHECK(there.limits.empty());
    CHECK(pieces > 3);  // a range is 0.3 long, and 0.2 of it are pulled
    CHECK(norm(tip(model, robot) - wanted) <= 1e-4);
    for (const double value : drag.values(robot)) CHECK(value >= 0.7);
    const Led back = lead_to(drag, robot, rest, pieces);
    CHECK(back.reached);
    CHECK(norm(tip(model, robot) - rest) <= 1e-4);
}

TEST_CASE("out of reach the tip stops at the nearest point and reports the limits") {
    const Model model = made(bar(1));
    Stepper stepper(model, tight);
    const InverseTask task = task_for(model, {{0.9, 1}});
    MarkerDrag drag(stepper, task.inputs, 0);
    RobotState robot = stepper.rest();
    int pieces = 0;
    const Led led = lead_to(drag, robot, {0, 0, 0.2}, pieces);
    CHECK_FALSE(led.reached);
    REQUIRE(led.limits.size() == 1);
    CHECK(text(led.limits[0]) == "above is at the lower end of its range");
    CHECK(drag.values(robot)[0] == near(0.9, {.absolute = 1e-9}));
    CHECK(led.error_m == near(norm(tip(model, robot) - Vec3{0, 0, 0.2}), {.relative = 1e-12}));
}

TEST_CASE("dragging replaces inputs of another kind from the sliders") {
    const Model model = made(bar(1));
    const InverseTask task = task_for(model, {{0.7, 1}});
    const Vec3 wanted = tip_under(model, task, {0.85});
    Stepper stepper(model, tight);
    RobotState robot = stepper.rest();
    Inputs pulled = robot.inputs;
    pulled.drives[0] = {Drive::Kind::multiplier, 2.0};
    REQUIRE(stepper.drive(robot, pulled, {}).arrived);
    MarkerDrag drag(stepper, task.inputs, 0);
    int pieces = 0;
    CHECK(lead_to(drag, robot, wanted, pieces).reached);
    CHECK(drag.values(robot)[0] == near(0.85, {.absolute = 5e-3}));
}
