#include "plan/swap.hpp"

#include <cmath>
#include <cstdlib>

#include "machine/motion.hpp"

namespace pliant::plan {
namespace {

using machine::Axis;
using machine::Position;
using machine::Printer;

constexpr int most_strokes = 1000;

int lowered_um(const Printer& p, int slot) {
    return p.level_um(slot) - p.hooks.travel_um;
}

/// Position after stroke i of n: out and up on odd strokes, back on even ones, the tower evenly on its way.
Position stroke_end(const Printer& p, const Position& start, int tower_um, int i, int n) {
    Position end = start;
    if (i % 2 == 1) {
        end[Axis::carriage] -= p.cleaning.stroke_x_um;
        end[Axis::platform] += p.cleaning.stroke_z_um;
    }
    const auto way = static_cast<long long>(tower_um - start[Axis::tower]);
    end[Axis::tower] += static_cast<int>(way * i / n);
    return end;
}

/// Feed along the path at which the carriage runs at cleaning speed.
double stroke_feed(const Printer& p, const Position& from, const Position& to) {
    const double way_mm = std::abs(to[Axis::carriage] - from[Axis::carriage]) / 1000.0;
    return p.cleaning.speed_mm_s * machine::profile(p, from, to, 0).length_mm / way_mm;
}

double stroke_seconds(const Printer& p, const Position& start, int tower_um, int n) {
    double seconds = 0;
    Position at = start;
    for (int i = 1; i <= n; ++i) {
        const Position next = stroke_end(p, start, tower_um, i, n);
        seconds += machine::move_seconds(p, at, next, stroke_feed(p, at, next));
        at = next;
    }
    return seconds;
}

/// As many pairs of strokes as the time allows; at least one pair, which also carries the tower.
int stroke_count(const Printer& p, const Position& start, int tower_um, double seconds) {
    int n = 2;
    while (n + 2 <= most_strokes && stroke_seconds(p, start, tower_um, n + 2) <= seconds) n += 2;
    return n;
}

/// Step 3 between backing off and advancing: at least `seconds` long.
void oscillate(Sequence& s, int tower_um, double seconds) {
    const Printer& p = s.printer();
    const Position start = s.position();
    const int n = stroke_count(p, start, tower_um, seconds);
    for (int i = 1; i <= n; ++i) {
        const Position end = stroke_end(p, start, tower_um, i, n);
        s.move_to(end, stroke_feed(p, s.position(), end));
    }
    s.dwell(seconds - stroke_seconds(p, start, tower_um, n));
}

/// Steps 1 and 2, up to the carriage standing back with the pump running.
void push_away(Sequence& s, int slot) {
    const Printer& p = s.printer();
    s.activity(Activity::swap);
    s.move(Axis::carriage, p.carriage.tower_um);
    s.switch_to(p.pump.on);
    s.activity(Activity::clean);
    s.move(Axis::tower, lowered_um(p, slot), p.hooks.speed_mm_s);
    s.move(Axis::carriage, p.carriage.tower_um - p.carriage.back_off_um);
}

void pump_off(Sequence& s) {
    s.switch_to(s.printer().pump.off);
    s.activity(Activity::swap);
}

/// Step 5.
void pull_in(Sequence& s) {
    const Printer& p = s.printer();
    s.switch_to(p.fans.on);
    s.move(Axis::carriage, p.carriage.print_um);
    s.dwell(p.cleaning.dry_s);
    s.switch_to(p.fans.off);
    s.activity(Activity::move);
}

double hook_seconds(const Printer& p) {
    return machine::move_seconds(p, {}, {{0, 0, p.hooks.travel_um}}, p.hooks.speed_mm_s);
}

double back_off_seconds(const Printer& p) {
    return machine::move_seconds(p, {}, {{p.carriage.back_off_um, 0, 0}}, 0);
}

}  // namespace

void load_vat(Sequence& s, int slot) {
    const Printer& p = s.printer();
    s.activity(Activity::swap);
    s.move(Axis::tower, lowered_um(p, slot));
    s.move(Axis::carriage, p.carriage.tower_um);
    s.move(Axis::tower, p.level_um(slot), p.hooks.speed_mm_s);
    s.move(Axis::carriage, p.carriage.print_um);
    s.activity(Activity::move);
}

void swap_vat(Sequence& s, int from_slot, int to_slot) {
    const Printer& p = s.printer();
    push_away(s, from_slot);
    oscillate(s, lowered_um(p, to_slot), p.cleaning.spray_s - 2 * hook_seconds(p) - 2 * back_off_seconds(p));
    s.move(Axis::carriage, p.carriage.tower_um);
    s.move(Axis::tower, p.level_um(to_slot), p.hooks.speed_mm_s);
    pump_off(s);
    pull_in(s);
}

void store_vat(Sequence& s, int slot) {
    const Printer& p = s.printer();
    push_away(s, slot);
    oscillate(s, lowered_um(p, slot), p.cleaning.spray_s - hook_seconds(p) - back_off_seconds(p));
    pump_off(s);
    pull_in(s);
}

}  // namespace pliant::plan
