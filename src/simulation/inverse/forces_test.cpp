// Forces as goals: their derivatives beside differences of equilibria, and that they are met.
#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "simulation/inverse/force_goals.hpp"
#include "simulation/inverse/test_robots.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::inverse;
using namespace pliant::sim::inverse::testing;

namespace {

/// The bar with one cable over a table that it is bent down on.
Description over_table() {
    Description d = bar(2);
    ContactRules rules;
    rules.surface = contact::robot_surface(d.mesh);
    rules.settings = {0.05 * width, 1e5, 0, 1e-5, true};
    const contact::HalfSpace table{{0, 0, -0.4 * width}, {0, 0, 1}};
    rules.obstacles.push_back({{"table", table, 0}, {}});
    d.contact = std::move(rules);
    return d;
}

Goal force_goal(GoalKind kind, const Vec3& force, bool sum) {
    Goal goal;
    goal.name = "press";
    goal.kind = kind;
    goal.sum_of_sizes = sum;
    goal.wanted = {{force}};
    goal.tolerance = 1e-3;
    return goal;
}

/// d of each number of the goal's force with each share, linearised and by differences of equilibria.
void check_gradients(const Goal& goal, const std::vector<double>& values) {
    const Model model = made(over_table());
    InverseTask task = task_for(model, {{0.8, 1}, {0.8, 1}});
    task.goals = {goal};
    Stepper stepper(model, {.tolerance = 1e-9, .time_unit = 0.1});
    const InputSpace space(stepper, task);
    const GoalRows rows(stepper, task, space);
    Eigen::VectorXd shares(2);
    for (Eigen::Index i = 0; i < 2; ++i) shares[i] = space.share(i, values[static_cast<std::size_t>(i)]);
    RobotState robot = stepper.rest();
    REQUIRE(stepper.drive(robot, space.inputs(shares, 1), {}).arrived);
    auto sensitivity = Sensitivity::create(stepper, space, robot);
    REQUIRE(sensitivity);
    sensitivity->use(rows.gradients(sensitivity->at(), 0, {}));
    for (Eigen::Index i = 0; i < 2; ++i) {
        if (space.is_slack(robot, i)) continue;
        const auto at = [&](double change) {
            RobotState moved = robot;
            Eigen::VectorXd there = shares;
            there[i] += change;
            REQUIRE(stepper.drive(moved, space.inputs(there, 1), {}).arrived);
            return rows.values(moved, there, 0, {});
        };
        constexpr double h = 1e-4;
        const Eigen::VectorXd difference = (at(h) - at(-h)) / (2 * h);
        const Eigen::VectorXd product = sensitivity->multiply(Eigen::VectorXd::Unit(2, i));
        REQUIRE(difference.size() == product.size());
        CHECK(difference.norm() > 0);
        for (Eigen::Index k = 0; k < product.size(); ++k)
            CHECK(product[k] == near(difference[k], {.absolute = 1e-4 * difference.norm()}));
        const Eigen::VectorXd weights = Eigen::VectorXd::LinSpaced(product.size(), 1, 2);
        CHECK(sensitivity->multiply_transposed(weights)[i] == near(weights.dot(product), {.relative = 1e-4}));
    }
}

}  // namespace

TEST_CASE("derivatives of support and contact forces by inputs agree with equilibria") {
    check_gradients(force_goal(GoalKind::support_force, {}, false), {1, 0.88});
    check_gradients(force_goal(GoalKind::contact_force, {}, false), {1, 0.88});
    check_gradients(force_goal(GoalKind::contact_force, {}, true), {1, 0.88});
}

TEST_CASE("the bar is pressed on the table with the wanted force") {
    const Model model = made(over_table());
    InverseTask task = task_for(model, {{0.8, 1}, {0.8, 1}});
    task.goals = {force_goal(GoalKind::contact_force, {0.05, 0, 0}, true)};
    task.inputs.erase(task.inputs.begin());
    // Nothing touches at rest, where the force has no derivative: another goal leads there.
    Goal down = at_point({});
    down.kind = GoalKind::plane;
    down.wanted = {{{0, 0, 0.35 * width}, {0, 0, 1}}};
    down.tolerance = 10 * width;
    task.goals.push_back(down);
    const Waypoint found = solve(model, task).waypoints.at(0);
    CHECK(found.reached);
    CHECK(found.goals[0].got[0].x == near(0.05, {.absolute = 1e-3}));
    CHECK(found.state.contacts[0].force_N.z == near(found.goals[0].got[0].x, {.relative = 1e-3}));
    // Alone it says nothing about the cables, which are slack at rest: neither that they would have to push.
    task.goals.pop_back();
    const Waypoint apart = solve(model, task, {.starts = 0}).waypoints.at(0);
    CHECK_FALSE(apart.reached);
    for (const Limit& limit : apart.limits) CHECK(limit.kind != Limit::Kind::slack);
}
