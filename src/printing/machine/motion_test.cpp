#include "printing/machine/motion.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"

using namespace pliant::machine;
using pliant::near;

namespace {

/// Carriage 10 mm/s and 20 mm/s^2, platform 4 and 8, tower 40 and 200.
Printer simple() {
    Printer p;
    p.axes[0] = {'X', 0, 100000, 10, 20, false, 5};
    p.axes[1] = {'Z', 0, 100000, 4, 8, true, 5};
    p.axes[2] = {'Y', 0, 100000, 40, 200, false, 5};
    return p;
}

}  // namespace

TEST_CASE("a long move is a trapezoid, a short one a triangle") {
    const Printer p = simple();
    // 100 mm at 10 mm/s and 0.5 s of ramp on either side: 100/10 + 10/20.
    CHECK(move_seconds(p, {{0, 0, 0}}, {{100000, 0, 0}}, 0) == near(10.5, {.relative = 1e-12}));
    // Half the speed by the feed rate: 100/5 + 5/20.
    CHECK(move_seconds(p, {{0, 0, 0}}, {{100000, 0, 0}}, 5) == near(20.25, {.relative = 1e-12}));
    // 1.25 mm: never reaches 10 mm/s (that takes 5 mm); 2 sqrt(1.25/20).
    CHECK(move_seconds(p, {{0, 0, 0}}, {{1250, 0, 0}}, 0) == near(0.5, {.relative = 1e-12}));
    CHECK(move_seconds(p, {{0, 0, 0}}, {{0, 0, 0}}, 0) == 0);
}

TEST_CASE("in a coordinated move the slowest axis sets the time") {
    const Printer p = simple();
    // Along the diagonal both axes move 20 mm: the platform alone would take 20/4 + 4/8.
    CHECK(move_seconds(p, {{0, 0, 0}}, {{20000, 20000, 0}}, 0) == near(5.5, {.relative = 1e-12}));
}

TEST_CASE("motion is symmetric in time") {
    const Printer p = simple();
    const Position to{{100000, 0, 0}};
    const Profile way = profile(p, {}, to, 0);
    CHECK(position_at(way, {}, to, 0) == Position{});
    CHECK(position_at(way, {}, to, 0.5).um[0] == 2500);
    CHECK(position_at(way, {}, to, 5.25).um[0] == 50000);
    CHECK(position_at(way, {}, to, 10.0).um[0] == 97500);
    CHECK(position_at(way, {}, to, 99).um[0] == 100000);
}

TEST_CASE("homing takes the distance to the switch over the homing speed") {
    const Printer p = simple();
    CHECK(home_seconds(p, Axis::platform, 40000) == near(12, {.relative = 1e-12}));
    CHECK(home_seconds(p, Axis::carriage, 40000) == near(8, {.relative = 1e-12}));
}
