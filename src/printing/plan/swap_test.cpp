#include "printing/plan/swap.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/core/near.hpp"
#include "printing/plan/test_jobs.hpp"

using namespace pliant;
using namespace pliant::plan;
using machine::Axis;
using pliant::plan::test::machine_of;

namespace {

/// A sequence with the vat of slot 1 under a platform that is clear.
Sequence loaded(const machine::Printer& printer) {
    Sequence s(printer);
    s.move(Axis::platform, printer.clear_um(1000));
    load_vat(s, 1);
    s.move(Axis::platform, printer.push_um(1000));
    return s;
}

double seconds_of_swap(const machine::Printer& printer, int to_slot) {
    Sequence s = loaded(printer);
    const double before = s.seconds().total;
    swap_vat(s, 1, to_slot);
    CHECK(s.position()[Axis::tower] == printer.level_um(to_slot));
    CHECK(s.position()[Axis::carriage] == 0);
    CHECK(s.position()[Axis::platform] == printer.clear_um(1000));
    return s.seconds().total - before;
}

}  // namespace

TEST_CASE("a swap with the next slot takes the thesis' 62 to 63 s, computed from its motions") {
    const machine::Printer printer = plan::test::tower();
    Sequence s = loaded(printer);
    const Seconds before = s.seconds();
    swap_vat(s, 1, 2);
    const Seconds after = s.seconds();
    // Push and pull: 355.6 mm at 15.2 mm/s, ramps of 50 mm/s^2. The pump runs for the 15 s in between.
    const double stroke = 355.6 / 15.2 + 15.2 / 50;
    CHECK(after.swap - before.swap == near(2 * stroke, {.relative = 1e-12}));
    CHECK(after.clean - before.clean == near(15, {.relative = 1e-4}));
    CHECK(after.total - before.total == near(2 * stroke + 15, {.relative = 1e-4}));
    CHECK(after.total - before.total > 62);
    CHECK(after.total - before.total < 63);
    // The hooks: 29.5 mm at 10 mm/s, ramps of 200 mm/s^2.
    CHECK(29.5 / 10 + 10.0 / 200 == near(3, {.relative = 1e-12}));
}

TEST_CASE("a far slot adds the time that the tower needs beyond the spray") {
    const machine::Printer printer = plan::test::tower();
    const double next = seconds_of_swap(printer, 2);
    const double far = seconds_of_swap(printer, 4);
    // Three pitches in two strokes: 2 (304.8/40 + 40/200), hooks and back-off as before, nothing to fill up.
    const double hooks = 29.5 / 10 + 10.0 / 200;
    const double back_off = 15 / 15.2 + 15.2 / 50;
    const double stroke = 355.6 / 15.2 + 15.2 / 50;
    CHECK(far == near(2 * stroke + 2 * hooks + 2 * back_off + 2 * (304.8 / 40 + 0.2), {.relative = 1e-12}));
    CHECK(far > next);
}

TEST_CASE("a slower carriage makes the same swap longer, as its motions say") {
    machine::Printer slow = plan::test::tower();
    const double before = seconds_of_swap(slow, 2);
    slow.axes[0].speed_mm_s /= 2;
    slow.cleaning.speed_mm_s /= 2;
    const double push = 355.6 / 7.6 + 7.6 / 50;
    CHECK(seconds_of_swap(slow, 2) > before + 40);
    CHECK(seconds_of_swap(slow, 2) == near(2 * push + 15, {.relative = 0.02}));
}

TEST_CASE("the brush wipes a part 1 mm above the rim for 10 s, without extra time") {
    machine::Printer printer = plan::test::tower();
    const double with_s = seconds_of_swap(printer, 2);
    Sequence s = loaded(printer);
    CHECK(s.position()[Axis::platform] == 1000 + 82550 + 1000);
    const std::size_t before = s.text().size();
    swap_vat(s, 1, 2);
    const std::string swap = s.text().substr(before);
    // Off the hooks and off the brush in one move: 1 mm up while the tower lowers by 29.5 mm at 10 mm/s.
    CHECK(swap.find("G1 Z85.550 Y0.500 F600.3") != std::string::npos);
    printer.cleaning.brush = false;
    CHECK(seconds_of_swap(printer, 2) == near(with_s, {.relative = 1e-12}));
    CHECK(loaded(printer).position()[Axis::platform] == 1000 + 82550 + 2000);
}

TEST_CASE("every fan dries the part while the next vat comes, and at no other time") {
    const machine::Printer printer = plan::test::tower();
    REQUIRE(printer.fans.size() == 2);
    Sequence s = loaded(printer);
    const std::size_t before = s.text().size();
    swap_vat(s, 1, 2);
    const std::string swap = s.text().substr(before);
    const std::string on = "M106 P0 S255\nM106 P2 S255\n", off = "M107 P0\nM107 P2\n";
    REQUIRE(swap.find(on) != std::string::npos);
    CHECK(swap.find(on) > swap.find("M107 P1\n"));  // after the spray
    CHECK(swap.find("X0.000") > swap.find(on));
    CHECK(swap.find(off) > swap.find("X0.000"));
    CHECK(swap.rfind("M106 P0") == swap.find(on));
}

namespace {

/// From rest to rest along a straight line of lift and rail, in mm: 200 mm/s and 400 mm/s^2, 300 mm/s and 600 mm/s^2.
double retriever_seconds(double lift_mm, double rail_mm) {
    const double way = std::hypot(lift_mm, rail_mm);
    const double speed = std::min(lift_mm > 0 ? 200 * way / lift_mm : 1e9, rail_mm > 0 ? 300 * way / rail_mm : 1e9);
    const double acceleration =
        std::min(lift_mm > 0 ? 400 * way / lift_mm : 1e9, rail_mm > 0 ? 600 * way / rail_mm : 1e9);
    return way > speed * speed / acceleration ? way / speed + speed / acceleration : 2 * std::sqrt(way / acceleration);
}

}  // namespace

TEST_CASE("a magnet saves the hooks' strokes: a far slot is faster, and the next one waits for the spray only") {
    const machine::Printer magnet = machine_of("tower_magnet");
    const double stroke = 355.6 / 15.2 + 15.2 / 50, back_off = 15 / 15.2 + 15.2 / 50;
    CHECK(swap_seconds(magnet, 1, 2).total / (2 * stroke + 15) == near(1, {.relative = 1e-4}));
    // Released in 0.5 s, while the platform rises 1 mm off the brush; held after 0.2 s.
    const double rise = 2 * std::sqrt(1 / 100.0);
    const double far = 2 * stroke + 0.5 + rise + 0.2 + 2 * back_off + 2 * (304.8 / 40 + 0.2);
    CHECK(swap_seconds(magnet, 1, 4).total / far == near(1, {.relative = 1e-4}));
    CHECK(swap_seconds(magnet, 1, 4).total < swap_seconds(plan::test::tower(), 1, 4).total - 4);
    Sequence s = loaded(magnet);
    const std::size_t before = s.text().size();
    swap_vat(s, 1, 2);
    const std::string swap = s.text().substr(before);
    const std::size_t off = swap.find("M400\nM42 P11 S0\nG4 P500\n"), on = swap.find("M400\nM42 P11 S255\nG4 P200\n");
    REQUIRE(off != std::string::npos);
    REQUIRE(on != std::string::npos);
    CHECK(off > swap.find("X355.600"));
    CHECK(off < swap.find("X340.600"));
    CHECK(on > off);
    CHECK(on < swap.find("X0.000"));
}

TEST_CASE("without spray a wall's swap is the sum of carriage, hooks and retriever") {
    machine::Printer wall = machine_of("wall");
    const double stroke = 355.6 / 15.2 + 15.2 / 50, back_off = 15 / 15.2 + 15.2 / 50;
    // Down 29.5 mm at 10 mm/s while the platform rises 1 mm at 100 mm/s^2; up again alone.
    const double path = std::hypot(29.5, 1), speed = 10 * path / 29.5;
    const double down = path / speed + speed / (400 * path / 29.5), up = 29.5 / 10 + 10.0 / 400;
    const double lift_off = 20.0 / 20 + 20.0 / 400, fork = 1.5;
    // Slot 1 is at 20 and 50 mm, slot 7 at 731.2 and 202.4; the bay at 480 and 300, lowered by 29.5.
    const double put = retriever_seconds(270.5 - 50, 460) + fork + lift_off + fork;
    const double fetch =
        retriever_seconds(202.4 - 20 - 30, 711.2) + fork + lift_off + fork + retriever_seconds(270.5 - 202.4, 251.2);
    const double all = 2 * stroke + down + 2 * back_off + put + fetch + up;
    wall.cleaning.spray_s = 0;
    CHECK(swap_seconds(wall, 1, 7).total / all == near(1, {.relative = 1e-4}));
}

TEST_CASE("a wall's retriever works during the spray, and the spray does not wait for it") {
    const machine::Printer wall = machine_of("wall");
    machine::Printer dry = wall;
    dry.cleaning.spray_s = 0;
    const double way_s = swap_seconds(dry, 1, 7).total;
    const Seconds near = swap_seconds(wall, 1, 7);
    CHECK(near.clean >= 15);
    CHECK(near.clean < 21);
    CHECK(near.total < way_s + 6);
    machine::Printer slow = wall;
    slow.axes[static_cast<std::size_t>(Axis::table)].speed_mm_s = 5;
    const Seconds late = swap_seconds(slow, 1, 7);
    CHECK(late.clean < 15 + 6);
    CHECK(late.total > 200);
    machine::Printer long_spray = wall;
    long_spray.cleaning.spray_s = 100;
    CHECK(swap_seconds(long_spray, 1, 7).clean == pliant::near(100, {.relative = 0.02}));
}
