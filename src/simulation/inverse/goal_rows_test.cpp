// How far apart two results for a goal are.
#include "simulation/inverse/goal_rows.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::inverse;

namespace {

double difference_of(GoalKind kind, const std::vector<Vec3>& wanted, const std::vector<Vec3>& one,
                     const std::vector<Vec3>& other, bool sizes = false) {
    Goal goal;
    goal.kind = kind;
    goal.wanted = {wanted};
    goal.sum_of_sizes = sizes;
    return difference(goal, {0, true, one}, {0, true, other}, 0);
}

}  // namespace

TEST_CASE("results of a goal of any kind are compared with each other, not with what is wanted") {
    const Vec3 x{1, 0, 0}, z{0, 0, 1};
    CHECK(difference_of(GoalKind::position, {{}, {}}, {{0, 0, 1}, {5, 0, 0}}, {{0, 0, 1}, {2, 0, 4}}) ==
          near(5, {.relative = 1e-12}));
    CHECK(difference_of(GoalKind::plane, {{0, 0, 9}, z}, {{3, 4, 1}}, {{0, 0, -1}}) == near(2, {.relative = 1e-12}));
    CHECK(difference_of(GoalKind::direction, {z}, {x}, {z}) == near(std::acos(0.0), {.relative = 1e-12}));
    CHECK(difference_of(GoalKind::support_force, {z}, {{3, 0, 0}}, {{0, 4, 0}}) == near(5, {.relative = 1e-12}));
    CHECK(difference_of(GoalKind::contact_force, {x}, {{3, 0, 0}}, {{1, 0, 0}}, true) == near(2, {.relative = 1e-12}));
}
