#include "plan/swap.hpp"

#include <doctest/doctest.h>

#include "plan/test_jobs.hpp"

using namespace pliant;
using namespace pliant::plan;
using machine::Axis;

namespace {

/// A sequence that stands with the vat of slot 1 under a platform that is clear.
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

TEST_CASE("a swap with the next slot takes the 62 to 63 s of the thesis, from its motions") {
    const machine::Printer printer = test::tower();
    Sequence s = loaded(printer);
    const Seconds before = s.seconds();
    swap_vat(s, 1, 2);
    const Seconds after = s.seconds();
    // Push and pull: 355.6 mm at 15.2 mm/s, ramps of 50 mm/s^2. The pump runs for the 15 s in between.
    const double stroke = 355.6 / 15.2 + 15.2 / 50;
    CHECK(after.swap - before.swap == doctest::Approx(2 * stroke));
    CHECK(after.clean - before.clean == doctest::Approx(15).epsilon(1e-4));
    CHECK(after.total - before.total == doctest::Approx(2 * stroke + 15).epsilon(1e-4));
    CHECK(after.total - before.total > 62);
    CHECK(after.total - before.total < 63);
    // The hooks: 29.5 mm at 10 mm/s, ramps of 200 mm/s^2.
    CHECK(29.5 / 10 + 10.0 / 200 == doctest::Approx(3));
}

TEST_CASE("a far slot costs what the tower's way takes beyond the spray") {
    const machine::Printer printer = test::tower();
    const double near = seconds_of_swap(printer, 2);
    const double far = seconds_of_swap(printer, 4);
    // Three pitches in two strokes: 2 (304.8/40 + 40/200), hooks and back-off as before, nothing to fill up.
    const double hooks = 29.5 / 10 + 10.0 / 200;
    const double back_off = 15 / 15.2 + 15.2 / 50;
    const double stroke = 355.6 / 15.2 + 15.2 / 50;
    CHECK(far == doctest::Approx(2 * stroke + 2 * hooks + 2 * back_off + 2 * (304.8 / 40 + 0.2)));
    CHECK(far > near);
}

TEST_CASE("the same swap on a slower carriage takes longer: times are motions, not entries") {
    machine::Printer slow = test::tower();
    const double before = seconds_of_swap(slow, 2);
    slow.axes[0].speed_mm_s /= 2;
    slow.cleaning.speed_mm_s /= 2;
    const double push = 355.6 / 7.6 + 7.6 / 50;
    CHECK(seconds_of_swap(slow, 2) > before + 40);
    CHECK(seconds_of_swap(slow, 2) == doctest::Approx(2 * push + 15).epsilon(0.02));
}

TEST_CASE("the brush wipes a part that hangs 1 mm over the rim for 10 s; it takes no time of its own") {
    machine::Printer printer = test::tower();
    const double with_s = seconds_of_swap(printer, 2);
    Sequence s = loaded(printer);
    CHECK(s.position()[Axis::platform] == 1000 + 82550 + 1000);
    const std::size_t before = s.text().size();
    swap_vat(s, 1, 2);
    const std::string swap = s.text().substr(before);
    // Off the hooks and off the brush in one move: 1 mm up while the tower lowers by 29.5 mm at 10 mm/s.
    CHECK(swap.find("G1 Z85.550 Y0.500 F600.3") != std::string::npos);
    printer.cleaning.brush = false;
    CHECK(seconds_of_swap(printer, 2) == doctest::Approx(with_s).epsilon(1e-6));
    CHECK(loaded(printer).position()[Axis::platform] == 1000 + 82550 + 2000);
}

TEST_CASE("every fan of the machine dries the part while the next vat comes, none at any other time") {
    const machine::Printer printer = test::tower();
    REQUIRE(printer.fans.size() == 2);
    Sequence s = loaded(printer);
    const std::size_t before = s.text().size();
    swap_vat(s, 1, 2);
    const std::string swap = s.text().substr(before);
    const std::string on = "M106 P0 S255\nM106 P2 S255\n", off = "M107 P0\nM107 P2\n";
    REQUIRE(swap.find(on) != std::string::npos);
    CHECK(swap.find(on) > swap.find("M107 P1\n"));  // behind the spray
    CHECK(swap.find("X0.000") > swap.find(on));
    CHECK(swap.find(off) > swap.find("X0.000"));
    CHECK(swap.rfind("M106 P0") == swap.find(on));
}
