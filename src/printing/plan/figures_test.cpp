#include "printing/plan/figures.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "printing/plan/test_jobs.hpp"

using namespace pliant;
using namespace pliant::plan;
using pliant::plan::test::machine_of;

TEST_CASE("the thesis' swap: 24, 3, 15 and 24 s take 62 to 63 s, since the hooks move during the spray") {
    const SwapSteps s = figures(machine_of("tower")).swap;
    CHECK(s.push_s == near(24, {.relative = 0.02}));
    CHECK(s.hooks_s == near(3, {.relative = 1e-12}));
    CHECK(s.clean_s == near(15, {.relative = 0.001}));
    CHECK(s.pull_s == near(24, {.relative = 0.02}));
    CHECK(s.total_s > 62);
    CHECK(s.total_s < 63);
    CHECK(s.push_s + s.hooks_s + s.clean_s + s.pull_s > 65);
}

TEST_CASE("table 4.1 against Zhou: 72 and 6 square inches, 8 and 2 vats, 62 and 180 s, 15 and 120 s") {
    const PrinterFigures tower = figures(machine_of("tower8"));
    const PrinterFigures rotary = figures(machine_of("rotary"));
    CHECK(tower.area_mm2 / square_inch_mm2 == near(72, {.relative = 1e-12}));
    CHECK(rotary.area_mm2 / square_inch_mm2 == near(6, {.relative = 0.001}));
    CHECK(tower.places == 8);
    CHECK(rotary.places == 2);
    CHECK(rotary.swap.total_s == near(180, {.relative = 0.02}));
    CHECK(rotary.swap.clean_s == near(120, {.relative = 1e-12}));
    CHECK(tower.removed > 0.9);
    CHECK(rotary.removed == near(0.59, {.relative = 1e-12}));
}

TEST_CASE("eight vats need 60 in; packing density 0.6 for four vats in the tower, 0.3 for two in a ring") {
    const machine::Printer tower = machine_of("tower");
    CHECK(tower_height_mm(tower, 8) == near(60 * 25.4, {.relative = 1e-12}));
    CHECK(tower_height_mm(tower, 9) - tower_height_mm(tower, 8) == near(8 * 25.4, {.relative = 1e-12}));
    CHECK(tower_packing(tower, 4) == near(4.0 / 7, {.relative = 1e-12}));
    CHECK(tower_packing(tower, 8) == near(8.0 / 15, {.relative = 1e-12}));
    CHECK(ring_packing(304.8, 152.4, 2) == near(0.3, {.relative = 0.02}));
}

TEST_CASE("the time to the next vat of a tower is constant; in rows and rings it grows with their vats") {
    const std::vector<int> vats = {2, 8, 32};
    const auto tower = swap_over_vats(machine_of("tower"), vats);
    const auto rotary = swap_over_vats(machine_of("rotary"), vats);
    const auto linear = swap_over_vats(machine_of("linear"), vats);
    CHECK(tower[0].next_s == near(tower[2].next_s, {.relative = 1e-12}));
    CHECK(linear[2].mean_s - linear[1].mean_s > 3 * (linear[1].mean_s - linear[0].mean_s));
    CHECK(linear[2].mean_s > linear[0].mean_s + 100);
    CHECK(rotary[2].mean_s > rotary[0].mean_s + 10);
}

TEST_CASE("the swap time grows with the bed's length, and falls with faster motors") {
    const machine::Printer tower = machine_of("tower");
    const auto swap_s = [&](double bed, double motors) { return figures(with_bed(tower, bed, motors)).swap.total_s; };
    CHECK(swap_s(1, 1) == near(figures(tower).swap.total_s, {.relative = 1e-12}));
    // Push and pull go 355.6 mm farther each, at 15.2 mm/s; and half as far.
    CHECK(swap_s(2, 1) - swap_s(1, 1) == near(2 * 355.6 / 15.2, {.relative = 1e-12}));
    CHECK(swap_s(1, 1) - swap_s(0.5, 1) == near(355.6 / 15.2, {.relative = 1e-12}));
    // At twice the speed: 355.6 / 30.4 s each way and a ramp of 30.4 / 50 s; the spray still takes its 15 s.
    CHECK(swap_s(1, 2) == near(2 * (355.6 / 30.4 + 30.4 / 50) + 15, {.relative = 1e-3}));
    CHECK(swap_s(1, 1000) > 15);  // with arbitrarily fast motors, ramps and cleaning remain
    const machine::Printer linear = machine_of("linear");
    CHECK(figures(with_bed(linear, 2, 1)).swap.total_s > figures(linear).swap.total_s);
}

TEST_CASE("a wall grows by columns; half its volume is the retriever's; a larger bed takes longer") {
    const machine::Printer wall = machine_of("wall");
    const PrinterFigures f = figures(wall);
    CHECK(f.places == 16);
    CHECK(f.swap.hooks_s == near(3, {.relative = 0.01}));
    // Four vats of 12 in at a pitch of 14 in, four of 4 in at a pitch of 6 in, and as much in front of them.
    CHECK(f.store_mm == near(54 * 25.4, {.relative = 1e-12}));
    CHECK(f.packing == near(48.0 / 54 * 16 / 22 / 2, {.relative = 1e-12}));
    const std::vector<SwapTimes> grown = swap_over_vats(wall, {4, 16, 32});
    CHECK(with_vats(wall, 32).wall.columns == 8);
    CHECK(with_vats(wall, 32).slot_count() == 32);
    CHECK(grown[2].mean_s > grown[0].mean_s);
    CHECK(grown[2].mean_s < grown[0].mean_s + 10);
    CHECK(figures(with_bed(wall, 2, 1)).swap.total_s > f.swap.total_s + 40);
    CHECK(figures(machine_of("tower_magnet")).swap.hooks_s == near(0.5, {.relative = 1e-12}));
}
