#include "robot/bodies/mesh_budget.hpp"

#include <doctest/doctest.h>

#include <array>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::robot;

namespace {

constexpr double most = 20000;

Bulk box(double a, double b, double c) {
    return {a * b * c, 2 * (a * b + b * c + c * a)};
}

}  // namespace

TEST_CASE("the nodes of a cube whose edges are 24 elements long: Gmsh gave 93175") {
    const std::array<Bulk, 1> cube = {box(10, 10, 10)};
    CHECK(expected_nodes(cube, {10.0 / 24, 3, 2}) == near(93175, {.relative = 0.05}));
    CHECK(fewest_nodes(cube, {10.0 / 24, 3, 2}) < 93175);
}

TEST_CASE("a solid with too many nodes gets longer edges, and keeps its elements through walls") {
    const std::array<Bulk, 1> cube = {box(10, 10, 10)};
    const Fineness coarser = within_budget(cube, {10.0 / 24, 3, 2}, most);
    CHECK(coarser.through_wall == 3);
    CHECK(expected_nodes(cube, coarser) <= most);
    CHECK(expected_nodes(cube, coarser) > 0.6 * most);
}

TEST_CASE("a thin shell gets fewer elements through its wall") {
    const Bulk outer = box(20, 10, 10), inner = box(19.4, 9.4, 9.4);
    const std::array<Bulk, 1> shell = {Bulk{outer.volume - inner.volume, outer.area + inner.area}};
    CHECK(expected_nodes(shell, {20.0 / 24, 3, 2}) > 1e6);
    const Fineness coarser = within_budget(shell, {20.0 / 24, 3, 2}, most);
    CHECK(coarser.through_wall < 3);
    CHECK(expected_nodes(shell, coarser) <= most);
}

TEST_CASE("what may be within the budget is left as it is, so that its mesh decides") {
    const std::array<Bulk, 2> fingers = {box(80, 16, 16), box(80, 16, 16)};
    const Fineness same = within_budget(fingers, {4.58, 3, 2}, most);
    CHECK(same.size == 4.58);
    CHECK(same.through_wall == 3);
}
