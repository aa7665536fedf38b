// Targets that a forward solution shows to be reachable are found.
#include "simulation/inverse/follow.hpp"

#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <utility>

#include "base/core/near.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/inverse/test_robots.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::inverse;
using namespace pliant::sim::inverse::testing;

namespace {

/// Solves for the position reached with `values`, and checks the result by an independent forward solution.
void check_found(Description d, const std::vector<std::pair<double, double>>& ranges, const std::vector<double>& values,
                 double tolerance = 1e-5) {
    const Model model = made(std::move(d));
    InverseTask task = task_for(model, ranges);
    const Vec3 wanted = tip_under(model, task, values);
    task.goals = {at_point(wanted, tolerance)};
    const InverseResult result = solve(model, task);
    REQUIRE_MESSAGE(result.waypoints.size() == 1, result.message);
    const Waypoint& found = result.waypoints[0];
    CHECK(found.reached);
    CHECK(found.goals[0].error <= tolerance);
    CHECK(found.limits.empty());
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        CHECK(found.values[i] >= ranges[i].first);
        CHECK(found.values[i] <= ranges[i].second);
    }
    CHECK(norm(tip_under(model, task, found.values) - wanted) <= tolerance);
}

}  // namespace

TEST_CASE("length, tension, volume and pressure are recovered from the position they cause") {
    check_found(bar(1), {{0.7, 1}}, {0.85});
    check_found(bar(1, 1, CableTarget::Kind::tension_N), {{0, 10}}, {4});
    check_found(bar(1, 1, CableTarget::Kind::shortening_m), {{0, 0.02}}, {0.007});
    const ChamberTarget volume{ChamberTarget::Kind::volume_ratio, 1}, pressure{ChamberTarget::Kind::pressure_Pa, 0};
    check_found(hollow(1, volume), {{0.8, 1}, {1, 1.5}}, {0.92, 1.3});
    check_found(hollow(1, pressure), {{0.8, 1}, {0, 1e4}}, {0.92, 5e3});
}

TEST_CASE("inputs of several cables are recovered, also with quadratic elements") {
    check_found(bar(2), {{0.7, 1}, {0.7, 1}}, {0.95, 0.8});
    check_found(bar(4), {{0.7, 1}, {0.7, 1}, {0.7, 1}, {0.7, 1}}, {0.8, 0.95, 0.9, 1});
    check_found(bar(3, 2), {{0.7, 1}, {0.7, 1}, {0.7, 1}}, {0.9, 1, 0.85});
}

namespace {

/// A closed path of the tip, every point of which is reachable.
InverseTask path_task(const Model& model, std::size_t waypoints) {
    InverseTask task = task_for(model, {{0.75, 1}, {0.75, 1}, {0.75, 1}});
    task.goals = {at_point({})};
    task.goals[0].wanted.clear();
    for (std::size_t k = 0; k < waypoints; ++k) {
        const double phase = 6.283185307179586 * static_cast<double>(k) / static_cast<double>(waypoints);
        task.goals[0].wanted.push_back(
            {tip_under(model, task, {0.9 - 0.04 * std::cos(phase), 0.97, 0.93 - 0.04 * std::sin(phase)})});
    }
    task.times.assign(waypoints, 1);
    return task;
}

}  // namespace

TEST_CASE("a path of 20 waypoints is followed, and its program reaches them") {
    Description d = bar(3);
    const Model model = made(d);
    const InverseTask task = path_task(model, 20);
    const InverseResult result = solve(model, task);
    REQUIRE(result.waypoints.size() == 20);
    CHECK(result.reached);
    int forward = 0;
    for (std::size_t k = 1; k < result.waypoints.size(); ++k) forward += result.waypoints[k].work.forward;
    CHECK(forward < 2 * 19);  // warm: hardly more than the waypoints themselves
    for (std::size_t c = 0; c < 3; ++c) {
        Curve keys{{0}, {1}};
        for (std::size_t k = 0; k < 20; ++k) {
            keys.time.push_back(static_cast<double>(k) + 1);
            keys.value.push_back(result.waypoints[k].values[c]);
        }
        d.cables[c].target.keys = keys;
    }
    const Program program{.steps = 20, .duration = 20, .tolerance = 1e-6, .checks = false};
    const Trajectory run = sim::testing::solve(std::move(d), program);
    REQUIRE_MESSAGE(run.converged, run.message);
    for (std::size_t k = 0; k < 20; ++k)
        CHECK(norm(run.steps[k + 1].markers[0].position_m - task.goals[0].wanted[k][0]) <= 1e-4);
}

TEST_CASE("the same bits on any number of threads") {
    const Model model = made(bar(3));
    const InverseTask task = path_task(model, 3);
    const auto solve_on = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return solve(model, task);
    };
    const InverseResult one = solve_on(1), four = solve_on(4);
    REQUIRE(one.waypoints.size() == four.waypoints.size());
    for (std::size_t k = 0; k < one.waypoints.size(); ++k) CHECK(one.waypoints[k].values == four.waypoints[k].values);
}

TEST_CASE("the inverse compensates loads that grow with the waypoints' times") {
    Description d = bar(2);
    d.loads = {
        {"weight", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > length - 1e-9; }), {}, {0, 0, -0.02}}};
    d.loads[0].shares.assign(d.loads[0].nodes.size(), 1.0 / static_cast<double>(d.loads[0].nodes.size()));
    const Model model = made(std::move(d));
    InverseTask task = task_for(model, {{0.7, 1}, {0.7, 1}});
    Goal height;
    height.name = "height";
    height.kind = GoalKind::plane;
    height.markers = {0};
    height.wanted = {{{0, 0, 0.6 * width}, {0, 0, 1}}};
    height.tolerance = 2e-5;
    task.goals = {height};
    task.times = {0.25, 0.5, 0.75, 1};
    task.timed = true;
    const InverseResult result = solve(model, task);
    REQUIRE(result.waypoints.size() == 4);
    CHECK(result.reached);
    for (std::size_t k = 1; k < 4; ++k) CHECK(result.waypoints[k].values[0] < result.waypoints[k - 1].values[0]);
}

TEST_CASE("with friction in the guides each waypoint is solved as a step from the one before") {
    Description d = bar(2);
    for (Cable& cable : d.cables) cable.friction = 0.2;
    const Model model = made(std::move(d));
    InverseTask task = task_for(model, {{0.75, 1}, {0.75, 1}});
    const Vec3 a = tip_under(model, task, {0.9, 0.98}), b = tip_under(model, task, {0.84, 0.98});
    task.goals = {at_point(a)};
    task.goals[0].wanted = {{a}, {b}, {a}};
    task.times = {1, 1, 1};
    const InverseResult result = solve(model, task);
    REQUIRE(result.waypoints.size() == 3);
    CHECK(result.reached);
    Stepper stepper(model, tight);
    const InputSpace space(stepper, task);
    RobotState robot = stepper.rest();
    for (const Waypoint& at : result.waypoints) {
        Eigen::VectorXd shares(2);
        for (Eigen::Index i = 0; i < 2; ++i) shares[i] = space.share(i, at.values[static_cast<std::size_t>(i)]);
        REQUIRE(stepper.drive(robot, space.inputs(shares, 1), {}).arrived);
        const Vec3 tip = position(model.description().markers[0].point, linalg::view(std::as_const(robot.now.state.x)));
        CHECK(norm(tip - at.state.markers[0].position_m) < 2e-5);
    }
}

TEST_CASE("if the search from rest fails, another starting point is used, and a note says so") {
    // At rest nothing touches the table, so its force has no derivative there.
    Description d = bar(2);
    ContactRules rules;
    rules.surface = contact::robot_surface(d.mesh);
    rules.settings = {0.05 * width, 1e5, 0, 1e-5, true};
    rules.obstacles.push_back({{"table", contact::HalfSpace{{0, 0, -0.4 * width}, {0, 0, 1}}, 0}, {}});
    d.contact = std::move(rules);
    const Model model = made(std::move(d));
    InverseTask task = task_for(model, {{0.85, 1}, {0.85, 1}});
    Goal press;
    press.name = "press";
    press.kind = GoalKind::contact_force;
    press.sum_of_sizes = true;
    press.wanted = {{{0.05, 0, 0}}};
    press.tolerance = 2e-3;
    task.goals = {press};
    const InverseResult result = solve(model, task);
    CHECK(result.reached);
    CHECK(result.notes.size() == 1);
    CHECK_FALSE(solve(model, task, {.starts = 0}).reached);
}

TEST_CASE("a cancelled search keeps the waypoints it has") {
    class AfterTwo final : public Progress {
    public:
        void advance(std::string_view, double fraction) override { over_ = fraction > 0.39; }
        [[nodiscard]] bool cancelled() const override { return over_; }

    private:
        bool over_ = false;
    } progress;
    const Model model = made(bar(3));
    const InverseTask task = path_task(model, 5);
    Stepper stepper(model, tight);
    const InverseResult result = follow(stepper, task, {}, progress);
    CHECK(result.cancelled);
    CHECK_FALSE(result.reached);
    CHECK(result.message == "cancelled at waypoint 3 of 5");
    REQUIRE(result.waypoints.size() == 3);
    CHECK_FALSE(result.waypoints[1].is_unfinished());
    CHECK(reasons(result.waypoints[1]).empty());
    CHECK(result.waypoints[2].is_unfinished());
    CHECK(reasons(result.waypoints[2]) == std::vector<std::string>{"the search was cancelled here"});
}

TEST_CASE("a step that lowers the penalty does not affect the prediction for the next waypoint") {
    const Model model = made(bar(2));
    InverseTask task = task_for(model, {{0.75, 1}, {0.75, 1}});
    task.inputs[0].effort_price = task.inputs[1].effort_price = 1;
    task.inputs[0].rest = task.inputs[1].rest = 0.95;  // both pull initially, and need not
    const Vec3 begin = tip_under(model, task, {0.95, 0.95}), end = tip_under(model, task, {0.9, 1});
    task.goals = {at_point(begin, 1e-3)};
    task.goals[0].wanted = {{begin}, {end}};
    task.times = {1, 1};
    const InverseResult result = solve(model, task);
    REQUIRE(result.waypoints.size() == 2);
    CHECK(result.reached);
    CHECK(result.waypoints[1].work.forward < 30);
}
