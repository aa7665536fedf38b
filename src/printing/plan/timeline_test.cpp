#include "printing/plan/timeline.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "base/core/near.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/test_jobs.hpp"

using namespace pliant;
using namespace pliant::plan;

namespace {

SwapTimeline timeline_of(const std::vector<std::vector<int>>& layers, const std::vector<std::string>& resins) {
    const machine::Printer printer = plan::test::tower();
    return longest_swap(make_plan(plan::test::make_job(layers, resins), printer).value(), printer);
}

std::vector<Stretch> of(const SwapTimeline& timeline, Device device) {
    std::vector<Stretch> found;
    for (const Stretch& s : timeline.stretches) {
        if (s.device == device) found.push_back(s);
    }
    return found;
}

}  // namespace

TEST_CASE("one swap as drawn in the thesis: push, spray during the tower's move, pull under the fans") {
    const SwapTimeline swap = timeline_of({{0, 1}, {0, 1}}, {"semi-flex", "rigid-flex"});
    CHECK(swap.from_slot == 1);
    CHECK(swap.to_slot == 2);
    // Push and pull: 355.6 mm at 15.2 mm/s, ramps of 50 mm/s^2; spray of 15 s between them.
    const double stroke = 355.6 / 15.2 + 15.2 / 50;
    CHECK(swap.seconds == near(2 * stroke + 15, {.relative = 1e-4}));
    const auto spray = of(swap, Device::pump);
    REQUIRE(spray.size() == 1);
    CHECK(spray[0].begin_s == near(stroke, {.relative = 1e-12}));
    CHECK(spray[0].end_s == near(stroke + 15, {.relative = 1e-4}));
    const auto fans = of(swap, Device::fans);
    REQUIRE(fans.size() == 1);
    CHECK(fans[0].begin_s == near(spray[0].end_s, {.relative = 1e-12}));
    CHECK(fans[0].end_s == near(swap.seconds, {.relative = 1e-12}));
    const auto tower = of(swap, Device::tower);
    REQUIRE(tower.size() == 3);  // hooks down, travel, hooks up
    CHECK(tower.front().begin_s == near(spray[0].begin_s, {.relative = 1e-12}));
    CHECK(tower.back().end_s == near(spray[0].end_s, {.relative = 1e-12}));
    const auto platform = of(swap, Device::platform);
    REQUIRE_FALSE(platform.empty());
    CHECK(platform.front().begin_s == near(spray[0].begin_s, {.relative = 1e-12}));  // off the brush
    // The brush passes below the 6 in of the bed at 15.2 mm/s; with the spray that is the 25 s of the thesis.
    const auto brush = of(swap, Device::brush);
    REQUIRE(brush.size() == 1);
    CHECK(brush[0].end_s - brush[0].begin_s == near(152.4 / 15.2, {.relative = 1e-12}));
    CHECK(brush[0].end_s - brush[0].begin_s + 15 == near(25, {.relative = 0.002}));
    CHECK((brush[0].begin_s + brush[0].end_s) / 2 == near(stroke / 2, {.relative = 1e-12}));
    CHECK(std::count(swap.devices.begin(), swap.devices.end(), Device::brush) == 1);
    CHECK(platform.back().end_s < spray[0].end_s);
    CHECK(of(swap, Device::light).empty());
}

TEST_CASE("the swap with the longest tower move is chosen; a job without swaps has none") {
    const SwapTimeline far = timeline_of({{0}, {1}, {2}, {0}}, {"semi-flex", "rigid-flex", "third"});
    CHECK(far.from_slot == 3);
    CHECK(far.to_slot == 1);
    CHECK(timeline_of({{0}, {0}}, {"semi-flex"}).stretches.empty());
}

TEST_CASE("the timeline ends with the job, and every exposure lies within its vat's visit") {
    const machine::Printer printer = plan::test::tower();
    const job::Manifest job = plan::test::make_job({{0, 1}, {0, 1}, {1}}, {"semi-flex", "rigid-flex"});
    const Plan plan = make_plan(job, printer).value();
    const JobTimeline all = job_timeline(plan, job, printer);
    CHECK(all.seconds == near(plan.seconds.total, {.relative = 1e-12}));
    REQUIRE(all.visits.size() == 5);
    int swaps = 0;
    for (std::size_t v = 1; v < all.visits.size(); ++v) {
        CHECK(all.visits[v].begin_s >= all.visits[v - 1].end_s);
        if (all.visits[v].slot == all.visits[v - 1].slot) continue;
        ++swaps;
        CHECK(all.visits[v].begin_s - all.visits[v - 1].end_s > longest_swap(plan, printer).seconds / 2);
    }
    CHECK(swaps == plan.swaps);
    double lit_s = 0;
    std::size_t lights = 0;
    for (const Stretch& s : all.stretches) {
        CHECK(s.end_s >= s.begin_s);
        CHECK(s.end_s <= all.seconds + 1e-9);
        if (s.device != Device::light) continue;
        REQUIRE(lights < all.visits.size());
        CHECK(s.begin_s >= all.visits[lights].begin_s);
        CHECK(s.end_s <= all.visits[lights].end_s);
        lit_s += s.end_s - s.begin_s;
        ++lights;
    }
    CHECK(lights == all.visits.size());
    CHECK(lit_s == near(plan.seconds.expose, {.relative = 1e-12}));
}

TEST_CASE("magnet, lift, rail and fork have their own rows") {
    const auto bars = [](const char* name, Device device) {
        const auto printer = machine::load_printer(fmt::format("examples/printers/{}.toml", name)).value();
        const SwapTimeline swap = swap_timeline(printer, printer.vats[0].slot, printer.vats[2].slot);
        CHECK(std::find(swap.devices.begin(), swap.devices.end(), device) != swap.devices.end());
        std::vector<Stretch> found;
        for (const Stretch& s : swap.stretches) {
            if (s.device == device) found.push_back(s);
        }
        return found;
    };
    const auto magnet = bars("tower_magnet", Device::magnet);
    REQUIRE(magnet.size() == 2);
    CHECK(magnet[0].end_s - magnet[0].begin_s == near(0.5, {.relative = 1e-12}));
    CHECK(magnet[1].end_s - magnet[1].begin_s == near(0.2, {.relative = 1e-12}));
    const auto fork = bars("wall", Device::fork);
    REQUIRE(fork.size() == 4);
    for (const Stretch& s : fork) CHECK(s.end_s - s.begin_s == near(1.5, {.relative = 1e-12}));
    CHECK(bars("wall", Device::rail).size() == 3);
    CHECK(bars("wall", Device::lift).size() >= 5);
    CHECK(device_name(Device::lift) == "lift");
}
