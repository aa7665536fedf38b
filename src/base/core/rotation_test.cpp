#include "base/core/rotation.hpp"

#include <doctest/doctest.h>

#include <numbers>

#include "base/core/near.hpp"

using namespace pliant;

namespace {

constexpr double right_angle = std::numbers::pi / 2;

void check_near(const Vec3& found, const Vec3& expected) {
    for (std::size_t k = 0; k < 3; ++k) CHECK(found[k] == near(expected[k], {.absolute = 1e-14}));
}

}  // namespace

TEST_CASE("rotations are right-handed: about z, x turns to y; about x, y to z; about y, z to x") {
    check_near(turned({1, 0, 0}, {0, 0, 1}, right_angle), {0, 1, 0});
    check_near(turned({0, 1, 0}, {1, 0, 0}, right_angle), {0, 0, 1});
    check_near(turned({0, 0, 1}, {0, 1, 0}, right_angle), {1, 0, 0});
    check_near(turned({1, 0, 0}, {0, 0, 1}, -right_angle), {0, -1, 0});
}

TEST_CASE("a third of a turn about the diagonal permutes the axes") {
    const Vec3 diagonal = unit({1, 1, 1});
    check_near(turned({1, 2, 3}, diagonal, 4 * right_angle / 3), {3, 1, 2});
    check_near(turned(diagonal, diagonal, 1.234), diagonal);
}

TEST_CASE("a rotation keeps lengths, and adds to the vector it is given") {
    const Vec3 axis = unit({1, -2, 0.5});
    const Vec3 arm{0.3, -4, 7};
    CHECK(norm(turned(arm, axis, 0.7)) == near(norm(arm), {.relative = 1e-14}));
    check_near(turned(arm, axis, 0.7, {10, 20, 30}), Vec3{10, 20, 30} + turned(arm, axis, 0.7));
    CHECK(turned(arm, axis, 0, {1, 2, 3}) == Vec3{1, 2, 3} + arm);
}
