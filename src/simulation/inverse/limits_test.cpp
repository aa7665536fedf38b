// Unreachable goals: the nearest reachable point, and the limits that prevent more.
#include <doctest/doctest.h>

#include <algorithm>

#include "base/core/near.hpp"
#include "simulation/inverse/test_robots.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::inverse;
using namespace pliant::sim::inverse::testing;

namespace {

/// The least distance from `wanted` over a grid of inputs.
double nearest_sampled(const Model& model, const InverseTask& task, const Vec3& wanted, int steps) {
    double least = 1e300;
    const auto value = [&](std::size_t i, int k) {
        return task.inputs[i].low + (task.inputs[i].high - task.inputs[i].low) * k / steps;
    };
    for (int a = 0; a <= steps; ++a) {
        for (int b = 0; b <= (task.inputs.size() > 1 ? steps : 0); ++b) {
            std::vector<double> values = {value(0, a)};
            if (task.inputs.size() > 1) values.push_back(value(1, b));
            least = std::min(least, norm(tip_under(model, task, values) - wanted));
        }
    }
    return least;
}

bool names(const Waypoint& at, Limit::Kind kind, const std::string& input) {
    return std::ranges::any_of(at.limits, [&](const Limit& l) { return l.kind == kind && l.input == input; });
}

}  // namespace

TEST_CASE("a goal beyond the range: the nearest point is at the range's end, which is named") {
    const Model model = made(bar(1));
    InverseTask task = task_for(model, {{0.85, 1}});
    const Vec3 wanted = tip_under(model, task, {0.75});
    task.goals = {at_point(wanted)};
    const Waypoint found = solve(model, task).waypoints.at(0);
    CHECK_FALSE(found.reached);
    CHECK(found.values[0] == near(0.85, {.absolute = 1e-9}));
    CHECK(names(found, Limit::Kind::lower, "above"));
    CHECK(text(found.limits[0]) == "above is at the lower end of its range");
    CHECK(found.goals[0].error == near(nearest_sampled(model, task, wanted, 20), {.absolute = 1e-5}));
}

TEST_CASE("a goal outside the workspace: the nearest point agrees with dense sampling") {
    const Model model = made(bar(2));
    InverseTask task = task_for(model, {{0.75, 1}, {0.75, 1}});
    for (const Vec3& aside : {Vec3{0.01, 0, 0.005}, Vec3{-0.004, 0.006, 0.001}, Vec3{0.004, 0.003, -0.03}}) {
        const Vec3 wanted = tip_under(model, task, {0.85, 1}) + aside;
        task.goals = {at_point(wanted)};
        const Waypoint found = solve(model, task).waypoints.at(0);
        CHECK_FALSE(found.reached);
        const double sampled = nearest_sampled(model, task, wanted, 24);
        CHECK(found.goals[0].error <= sampled + 2e-6);
        CHECK(found.goals[0].error >= sampled - 2e-4);
    }
}

TEST_CASE("a goal behind the wall, where searches from most places end far from the nearest point") {
    const Model model = made(bar(2));
    InverseTask task = task_for(model, {{0.7, 1}, {0.7, 1}});
    for (const Vec3& wanted : {Vec3{-0.05, 0.03, 0.017}, Vec3{-0.06, -0.02, -0.01}, Vec3{-0.03, 0.005, 0.05}}) {
        task.goals = {at_point(wanted)};
        const Waypoint found = solve(model, task).waypoints.at(0);
        CHECK_FALSE(found.reached);
        CHECK(found.goals[0].error <= nearest_sampled(model, task, wanted, 12) + task.goals[0].tolerance);
    }
}

TEST_CASE("a cable that would have to push is named; actuators that act in other directions are not") {
    const Model model = made(bar(1));
    InverseTask task = task_for(model, {{0.7, 1}});
    const Vec3 pulled = tip_under(model, task, {0.9});
    task.goals = {at_point({pulled.x, pulled.y, width - pulled.z})};
    const Waypoint up = solve(model, task).waypoints.at(0);
    CHECK_FALSE(up.reached);
    CHECK(names(up, Limit::Kind::slack, "above"));
    task.goals = {at_point(pulled + Vec3{0, 0.01, 0})};
    const Waypoint aside = solve(model, task).waypoints.at(0);
    CHECK_FALSE(aside.reached);
    CHECK(aside.limits.empty());
    CHECK(reasons(aside) == std::vector<std::string>{"no small change of the inputs brings it nearer"});
    CHECK(aside.goals[0].error == near(0.01, {.absolute = 2e-5}));
}

TEST_CASE("goals that contradict each other are named, not the slack antagonist") {
    const Model model = made(bar(2));
    InverseTask task = task_for(model, {{0.7, 1}, {0.7, 1}});
    const Vec3 up = tip_under(model, task, {0.9, 1});
    const auto on_plane = [&](const std::string& name, double z) {
        Goal goal;
        goal.name = name;
        goal.kind = GoalKind::plane;
        goal.markers = {0};
        goal.wanted = {{Vec3{up.x, up.y, z}, Vec3{0, 0, 1}}};
        goal.tolerance = 1e-5;
        return goal;
    };
    task.goals = {on_plane("high", up.z + 1e-3), on_plane("low", up.z - 1e-3)};
    const Waypoint found = solve(model, task).waypoints.at(0);
    CHECK_FALSE(found.reached);
    REQUIRE(found.limits.size() == 1);
    CHECK(text(found.limits[0]) ==
          "goals \"high\" and \"low\" contradict each other: what brings one nearer takes the other away");
    CHECK(found.goals[0].error == near(1e-3, {.relative = 0.03}));
    // Where all cables are slack their lengths change nothing, but a pull would.
    const Vec3 rest = tip_under(model, task, {1, 1});
    task.goals = {on_plane("high", rest.z + 1e-3), on_plane("low", rest.z - 1e-3)};
    const Waypoint slack = solve(model, task).waypoints.at(0);
    REQUIRE(slack.limits.size() == 1);
    CHECK(slack.limits[0].kind == Limit::Kind::goals);
}

TEST_CASE("an antagonist cable lengthens first and then pulls") {
    const Model model = made(bar(2));
    InverseTask task = task_for(model, {{0.7, 1}, {0.7, 1}});
    const Vec3 up = tip_under(model, task, {0.85, 1}), down = tip_under(model, task, {1, 0.85});
    task.goals = {at_point(up)};
    task.goals[0].wanted = {{up}, {down}, {up}};
    task.times = {1, 1, 1};
    const InverseResult result = solve(model, task);
    REQUIRE(result.waypoints.size() == 3);
    CHECK(result.reached);
}

TEST_CASE("a waypoint that the rate limit leaves out of reach names the rate") {
    const Model model = made(bar(1));
    InverseTask task = task_for(model, {{0.7, 1}});
    const Vec3 a = tip_under(model, task, {0.95}), b = tip_under(model, task, {0.85});
    task.goals = {at_point(a, 2e-5)};
    task.goals[0].wanted = {{a}, {b}, {b}};
    task.times = {1, 1, 1};
    task.inputs[0].rate = 0.06;
    const InverseResult result = solve(model, task);
    REQUIRE(result.waypoints.size() == 3);
    CHECK(result.waypoints[0].reached);
    CHECK_FALSE(result.waypoints[1].reached);
    CHECK(names(result.waypoints[1], Limit::Kind::rate, "above"));
    CHECK(result.waypoints[0].values[0] - result.waypoints[1].values[0] == near(0.06, {.absolute = 1e-9}));
    CHECK(result.waypoints[2].reached);
    CHECK_FALSE(result.reached);
}

TEST_CASE("a slack cable too changes by no more than its rate") {
    const Model model = made(bar(2));
    InverseTask task = task_for(model, {{0.7, 1.2}, {0.7, 1.2}});
    const Vec3 a = tip_under(model, task, {0.8, 1.2}), b = tip_under(model, task, {0.99, 1.2});
    task.goals = {at_point(a, 1e-4)};
    task.goals[0].wanted = {{a}, {b}};
    task.times = {1, 1};
    task.inputs[1].rate = 0.01;
    const InverseResult result = solve(model, task);
    REQUIRE(result.waypoints.size() == 2);
    CHECK(result.reached);
    const double change = result.waypoints[1].values[1] - result.waypoints[0].values[1];
    CHECK(change == near(-0.01, {.absolute = 1e-9}));  // free, it would be taken up by more
}

TEST_CASE("a slack cable that is too long to pull is at the end of its range") {
    const Model model = made(bar(1));
    InverseTask task = task_for(model, {{1.05, 1.2}});
    task.goals = {at_point(tip_under(model, task, {0.9}))};
    const Waypoint found = solve(model, task).waypoints.at(0);
    CHECK_FALSE(found.reached);
    CHECK(names(found, Limit::Kind::lower, "above"));
    CHECK_FALSE(names(found, Limit::Kind::slack, "above"));
}

TEST_CASE("for redundant cables a tension penalty gives the smallest tensions") {
    const Model model = made(bar(2, 1, CableTarget::Kind::tension_N));
    InverseTask task = task_for(model, {{0, 20}, {0, 20}});
    // Both pull: only their difference bends, but the sum shortens.
    Goal goal;
    goal.kind = GoalKind::plane;
    goal.markers = {0};
    const Vec3 tip = tip_under(model, task, {4, 0});
    goal.wanted = {{tip, {0, 0, 1}}};
    goal.tolerance = 1e-5;
    task.goals = {goal};
    task.inputs[0].effort_price = task.inputs[1].effort_price = 1;
    Stepper stepper(model, tight);
    Seeker seeker(stepper, task);
    Progress silent;
    const Point rest{stepper.rest(), seeker.space().rest()};
    Eigen::VectorXd both(2);
    both << 0.5, 0.4;
    const auto begin = seeker.move(rest, both, 1, seeker.whole_range(), silent);
    REQUIRE(begin);
    const Found found = seeker.seek(*begin, *begin, 0, seeker.whole_range(), silent);
    CHECK(found.reached);
    const double first = 20 * found.point.inputs[0], second = 20 * found.point.inputs[1];
    CHECK(first == near(4, {.absolute = 0.1}));
    CHECK(second == near(0, {.absolute = 0.1}));
}

TEST_CASE("points spread over a cube are Halton points") {
    CHECK(spread_point(1, 3)[0] == near(0.5, {.relative = 1e-15}));
    CHECK(spread_point(3, 3)[0] == near(0.75, {.relative = 1e-15}));
    CHECK(spread_point(4, 3)[1] == near(4.0 / 9, {.relative = 1e-15}));
    CHECK(spread_point(7, 3)[2] == near(2.0 / 5 + 1.0 / 25, {.relative = 1e-15}));
}
