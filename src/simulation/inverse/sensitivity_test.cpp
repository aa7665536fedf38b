// Predictions of a linearised state for changes of its inputs, and the number of solves they take.
#include "simulation/inverse/sensitivity.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "simulation/inverse/test_robots.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::inverse;
using namespace pliant::sim::inverse::testing;

namespace {

/// A bar with three cables, of which two pull.
struct Pulled {
    Pulled() : shares(Eigen::Vector3d(0.6, 1, 0.5)) {
        task.goals = {at_point({0.055, 0.005, 0.02})};
        robot = at(shares, nullptr, nullptr);
        REQUIRE(space.is_slack(robot, 1));
    }

    [[nodiscard]] RobotState at(const Eigen::VectorXd& wanted, const State* expected, int* iterations) {
        RobotState to = robot.controls.drives.empty() ? stepper.rest() : robot;
        const StepReport report = stepper.drive(to, space.inputs(wanted, 1), {}, expected);
        REQUIRE_MESSAGE(report.arrived, report.reason);
        if (iterations != nullptr) *iterations = report.iterations;
        return to;
    }

    [[nodiscard]] Sensitivity sensitivity() {
        auto made = Sensitivity::create(stepper, space, robot);
        REQUIRE(made);
        made->use(rows.gradients(made->at(), 0, {}));
        return std::move(*made);
    }

    Model model = made(bar(3));
    InverseTask task = task_for(model, {{0.75, 1}, {0.75, 1}, {0.75, 1}});
    Stepper stepper{model, tight};
    InputSpace space{stepper, task};
    GoalRows rows{stepper, task, space};
    RobotState robot;
    Eigen::VectorXd shares;
};

}  // namespace

TEST_CASE("combinations of solved directions need no further solution") {
    Pulled bar;
    Sensitivity known = bar.sensitivity(), fresh = bar.sensitivity();
    const Eigen::Vector3d a(1, 0.2, 0), b(0.1, 0, -1);
    (void)known.multiply(a);
    (void)known.multiply(b);
    CHECK(known.solutions() == 2);
    const Eigen::VectorXd found = known.multiply(0.3 * a - 2 * b), told = fresh.multiply(0.3 * a - 2 * b);
    CHECK(known.solutions() == 2);
    CHECK((found - told).norm() < 1e-4 * told.norm());
    const Eigen::VectorXd back = known.multiply_transposed(a), again = known.multiply_transposed(-4 * a);
    CHECK(known.solutions() == 3);
    CHECK((again + 4 * back).norm() < 1e-12 * back.norm());
    CHECK(a.dot(found) == near(back.dot(0.3 * a - 2 * b), {.relative = 1e-3}));
    (void)known.multiply(Eigen::Vector3d(0, 1, 0));
    CHECK(known.solutions() == 4);
}

TEST_CASE("Broyden updates also apply to stored products") {
    Pulled bar;
    Sensitivity at = bar.sensitivity();
    const Eigen::Vector3d step(0.1, 0, 0.05), miss(1, -2, 3);
    const Eigen::VectorXd before = at.multiply(step);
    at.learn(step, miss);
    CHECK((at.multiply(step) - before - miss).norm() < 1e-12 * (before + miss).norm());
    const Eigen::Vector3d across(0, 1, 0);
    const double straight = bar.sensitivity().multiply(across).dot(miss);
    CHECK(at.multiply_transposed(miss).dot(across) == near(straight, {.relative = 1e-3, .absolute = 1e-6}));
}

TEST_CASE("the predicted state's error is quadratic in the step, and the step from it ends at the same state") {
    Pulled bar;
    Sensitivity at = bar.sensitivity();
    const auto off = [&](double size) {
        const Eigen::Vector3d step = size * Eigen::Vector3d(-1, 0, 0.5);
        (void)at.multiply(step);
        const State expected = at.expected(bar.stepper, bar.robot.now.state, step);
        int from_there = 0, from_here = 0;
        const RobotState there = bar.at(bar.shares + step, &expected, &from_there);
        const RobotState here = bar.at(bar.shares + step, nullptr, &from_here);
        CHECK(from_there < from_here);
        CHECK((there.x() - here.x()).norm() < 1e-5 * (here.x() - bar.robot.x()).norm());
        return (expected.x - here.x()).norm();
    };
    const double whole = off(0.08), half = off(0.04);
    CHECK(half < 0.3 * whole);
}

TEST_CASE("a predicted state far from equilibrium has no effect") {
    Pulled bar;
    State wild = bar.robot.now.state;
    wild.x *= 1.5;
    const Eigen::VectorXd step = bar.shares + Eigen::Vector3d(-0.05, 0, 0);
    const RobotState told = bar.at(step, &wild, nullptr), alone = bar.at(step, nullptr, nullptr);
    CHECK(told.x() == alone.x());
}
