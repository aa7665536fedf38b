#include "printing/plan/retriever.hpp"

namespace pliant::plan {

using machine::Axis;
using machine::Printer;
using Kind = RetrieverStep::Kind;

namespace {

RetrieverStep way(int lift_um, int rail_um, double feed_mm_s = 0) {
    return {Kind::way, lift_um, rail_um, feed_mm_s};
}

}  // namespace

RetrieverTrip put_trip(const Printer& p, int slot) {
    const int level_um = p.row_um(slot), rail_um = p.column_um(slot);
    return {way(level_um, rail_um),
            {Kind::fork_out},
            way(level_um - p.wall.lift_off_um, rail_um, p.wall.lift_off_mm_s),
            {Kind::fork_in}};
}

RetrieverTrip fetch_trip(const Printer& p, int slot) {
    const int level_um = p.row_um(slot), rail_um = p.column_um(slot);
    return {way(level_um - p.wall.lift_off_um, rail_um),
            {Kind::fork_out},
            way(level_um, rail_um, p.wall.lift_off_mm_s),
            {Kind::fork_in},
            way(p.level_um(slot) - p.hooks.travel_um, p.station_um(slot))};
}

void ride(Sequence& s, const RetrieverTrip& trip) {
    for (const RetrieverStep& step : trip) {
        if (step.kind == Kind::way) {
            machine::Position to = s.position();
            to[Axis::tower] = step.lift_um;
            to[Axis::table] = step.rail_um;
            s.move_to(to, step.feed_mm_s);
        } else {
            s.fork(step.kind == Kind::fork_out);
            s.dwell(s.printer().wall.fork_s);
        }
    }
}

void clear_retriever(Sequence& s, const machine::Interlock& state) {
    const Printer& p = s.printer();
    if (p.store() != machine::Store::wall) return;
    s.dwell(p.wall.fork_s);  // the fork may still be moving
    if (!state.fork_out()) {
        if (const auto vat = state.tray_vat()) ride(s, put_trip(p, p.slot_of(*vat)));
        return;
    }
    const machine::Position at = s.position();
    for (int slot = 1; slot <= p.slot_count(); ++slot) {
        const int below_um = p.row_um(slot) - at[Axis::tower];
        if (at[Axis::table] != p.column_um(slot) || below_um < 0 || below_um > p.wall.lift_off_um) continue;
        const int low_um = p.row_um(slot) - p.wall.lift_off_um;
        return ride(s, {way(low_um, p.column_um(slot), p.wall.lift_off_mm_s), {Kind::fork_in}});
    }
}

}  // namespace pliant::plan
