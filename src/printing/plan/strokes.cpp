#include "printing/plan/strokes.hpp"

#include <cmath>
#include <cstdlib>
#include <utility>

#include "printing/machine/motion.hpp"

namespace pliant::plan {
namespace {

using machine::Axis;
using machine::Position;
using machine::Printer;

constexpr int most_strokes = 1000;

/// Position after stroke i of n: out and up on odd strokes, back on even ones, with the store moving evenly.
Position stroke_end(const Printer& p, const Position& start, const StoreEnd& store, int i, int n) {
    Position end = start;
    if (i % 2 == 1) {
        end[Axis::carriage] -= p.cleaning.stroke_x_um;
        end[Axis::platform] += p.cleaning.stroke_z_um;
    }
    for (const auto& [axis, to_um] : {std::pair{Axis::tower, store.tower_um}, {Axis::table, store.table_um}}) {
        const auto way = static_cast<long long>(to_um - start[axis]);
        end[axis] += static_cast<int>(way * i / n);
    }
    return end;
}

/// Feed along the path at which the carriage moves at cleaning speed; without a carriage, the platform.
double stroke_feed(const Printer& p, const Position& from, const Position& to) {
    const Axis lead = p.has_carriage() ? Axis::carriage : Axis::platform;
    const double way_mm = std::abs(to[lead] - from[lead]) / 1000.0;
    return way_mm > 0 ? p.cleaning.speed_mm_s * machine::profile(p, from, to, 0).length_mm / way_mm : 0;
}

double stroke_seconds(const Printer& p, const Position& start, const StoreEnd& store, int n) {
    double seconds = 0;
    Position at = start;
    for (int i = 1; i <= n; ++i) {
        const Position next = stroke_end(p, start, store, i, n);
        seconds += machine::move_seconds(p, at, next, stroke_feed(p, at, next));
        at = next;
    }
    return seconds;
}

void make_strokes(Sequence& s, const StoreEnd& store, int n) {
    const Printer& p = s.printer();
    const Position start = s.position();
    for (int i = 1; i <= n; ++i) {
        const Position end = stroke_end(p, start, store, i, n);
        s.move_to(end, stroke_feed(p, s.position(), end));
    }
}

/// As many pairs of strokes as fit into `seconds` or, with `fill`, as needed to last that long.
void oscillate_for(Sequence& s, const StoreEnd& store, double seconds, bool fill) {
    const Printer& p = s.printer();
    const Position start = s.position();
    int n = 2;
    while (n + 2 <= most_strokes &&
           (fill ? stroke_seconds(p, start, store, n) < seconds : stroke_seconds(p, start, store, n + 2) <= seconds))
        n += 2;
    make_strokes(s, store, n);
    s.dwell(seconds - stroke_seconds(p, start, store, n));
}

}  // namespace

StoreEnd store_at(const Sequence& s) {
    return {s.position()[Axis::tower], s.position()[Axis::table]};
}

void oscillate(Sequence& s, const StoreEnd& store, double seconds) {
    oscillate_for(s, store, seconds, false);
}

void oscillate_through(Sequence& s, const StoreEnd& store, double seconds) {
    oscillate_for(s, store, seconds, true);
}

}  // namespace pliant::plan
