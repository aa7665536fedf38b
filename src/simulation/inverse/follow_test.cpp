// Targets that a forward solution shows to be within reach are found.
#include "simulation/inverse/follow.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "simulation/inverse/test_robots.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::inverse;
using namespace pliant::sim::inverse::testing;

namespace {

/// Where `values` lead is found again, and the values found lead there by a forward solution of their own.
void check_found(Description d, const std::vector<std::pair<double, double>>& ranges, const std::vector<double>& values,
                 double tolerance = 1e-5) {
    const Model model = made(std::move(d));
    InverseTask task = task_for(model, ranges);
    const Vec3 wanted = tip_under(model, task, values);
    task.goals = {at_point(wanted, tolerance)};
    const InverseResult result = solve(model, task);
    REQUIRE_MESSAGE(result.waypoints.size() == 1, result.message);
    const Waypoint& found = result.waypoints[0];
    MESSAGE("forward ", found.work.forward, ", linearised ", found.work.linearised, ", solutions ",
            found.work.solutions, ", ", 1e3 * found.wall_s, " ms, error ", found.goals[0].error);
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

TEST_CASE("a length, a tension, a volume and a pressure are found again from where they lead") {
    check_found(bar(1), {{0.7, 1}}, {0.85});
    check_found(bar(1, 1, CableTarget::Kind::tension_N), {{0, 10}}, {4});
    check_found(bar(1, 1, CableTarget::Kind::shortening_m), {{0, 0.02}}, {0.007});
    const ChamberTarget volume{ChamberTarget::Kind::volume_ratio, 1}, pressure{ChamberTarget::Kind::pressure_Pa, 0};
    check_found(hollow(1, volume), {{0.8, 1}, {1, 1.5}}, {0.92, 1.3});
    check_found(hollow(1, pressure), {{0.8, 1}, {0, 1e4}}, {0.92, 5e3});
}

TEST_CASE("several cables are found again, also with quadratic elements") {
    check_found(bar(2), {{0.7, 1}, {0.7, 1}}, {0.95, 0.8});
    check_found(bar(4), {{0.7, 1}, {0.7, 1}, {0.7, 1}, {0.7, 1}}, {0.8, 0.95, 0.9, 1});
    check_found(bar(3, 2), {{0.7, 1}, {0.7, 1}, {0.7, 1}}, {0.9, 1, 0.85});
}
