#include "printing/plan/swap.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "printing/machine/motion.hpp"
#include "printing/plan/retriever.hpp"
#include "printing/plan/strokes.hpp"

namespace pliant::plan {
namespace {

using machine::Axis;
using machine::Position;
using machine::Printer;
using machine::Store;

int vat_of(const Printer& p, int slot) {
    return static_cast<int>(p.vat_of_slot(slot) - p.vats.data());
}

int lowered_um(const Printer& p, int slot) {
    return p.level_um(slot) - p.hooks.travel_um;
}

void pump_off(Sequence& s) {
    s.pump(false);
    s.activity(Activity::swap);
}

/// The table brings a station, by the shorter direction.
void table_to(Sequence& s, int station_um) {
    s.move(Axis::table, s.printer().nearest_um(station_um, s.position()[Axis::table]));
}

/// Fans on during the moves of `bring`, and during a rest afterwards.
template <class Bring>
void dry_while(Sequence& s, Bring bring) {
    const Printer& p = s.printer();
    s.fans(true);
    bring();
    s.dwell(p.cleaning.dry_s);
    s.fans(false);
    s.activity(Activity::move);
}

// Towers, and what a wall has in common with them.

/// The times, in seconds of a push, at which the brush starts and ends passing the platform. The brush is on the far
/// wall of a vat as long as the travel into the tower, with the platform at the vat's middle.
std::pair<double, double> brush_seconds(const Printer& p, const machine::Profile& push) {
    const double bed_mm = (p.carriage.along_y ? p.platform.depth_um : p.platform.width_um) / 1000.0;
    const double reach = std::min(1.0, bed_mm / push.length_mm);
    return {push.seconds_to((1 - reach) / 2), push.seconds_to((1 + reach) / 2)};
}

/// The vat goes into the tower; its brush, if any, wipes the part on the way.
void push_vat(Sequence& s) {
    const Printer& p = s.printer();
    Position in = s.position();
    in[Axis::carriage] = p.carriage.tower_um;
    if (p.has_brush()) {
        const machine::Profile push = machine::profile(p, s.position(), in, 0);
        const auto [begin_s, end_s] = brush_seconds(p, push);
        s.note(Device::brush, s.seconds().total + begin_s, s.seconds().total + end_s);
    }
    s.move_to(in);
}

/// The tower lowers the vat off the hooks, or the magnet releases it; the platform rises from the brush to the clear
/// height.
void let_go(Sequence& s, int slot) {
    const Printer& p = s.printer();
    s.magnet(false);
    Position to = s.position();
    const int way_um = std::abs(lowered_um(p, slot) - to[Axis::tower]);
    const int rise_um = p.clear_um(0) - p.push_um(0);
    to[Axis::tower] = lowered_um(p, slot);
    to[Axis::platform] += rise_um;
    s.move_to(to, way_um > 0 ? p.hooks.speed_mm_s * std::hypot(way_um, rise_um) / way_um : 0);
}

/// Steps 1 and 2, until the carriage is back with the pump running. Returns when the pump started, on the sequence's
/// clock.
double push_away(Sequence& s, int slot) {
    const Printer& p = s.printer();
    s.activity(Activity::swap);
    s.comment(p.has_brush() ? "1 push the vat away, the brush wipes the part" : "1 push the vat away");
    push_vat(s);
    s.comment(p.hooks.magnet.present() ? "2 spray, the magnet lets the vat go"
                                       : "2 spray, lower the vat off the hooks");
    s.pump(true);
    s.activity(Activity::clean);
    const double since_s = s.seconds().total;
    let_go(s, slot);
    s.move(Axis::carriage, p.carriage.tower_um - p.carriage.back_off_um);
    return since_s;
}

/// Step 3: sprays for `spray_s` minus the time since `since_s` and the duration of step 4.
void spray(Sequence& s, int to_slot, double since_s, double spray_s, double rest_s) {
    const Printer& p = s.printer();
    s.comment("3 oscillate over the drain while the store brings the next slot");
    if (p.has_table()) table_to(s, p.station_um(to_slot));
    oscillate(s, {lowered_um(p, to_slot), s.position()[Axis::table]}, spray_s - (s.seconds().total - since_s) - rest_s);
}

/// Latches the next vat: the tower raises it onto the hooks, or the magnet takes it.
void take(Sequence& s, int slot) {
    const Printer& p = s.printer();
    s.move(Axis::tower, p.level_um(slot), p.hooks.speed_mm_s);
    s.magnet(true);
}

/// The duration of take().
double take_seconds(const Printer& p) {
    if (p.hooks.magnet.present()) return p.hooks.magnet.engage_s;
    return machine::move_seconds(p, {}, {{0, 0, p.hooks.travel_um}}, p.hooks.speed_mm_s);
}

double back_off_seconds(const Printer& p) {
    return machine::move_seconds(p, {}, {{p.carriage.back_off_um, 0, 0}}, 0);
}

void load_from_tower(Sequence& s, int slot) {
    const Printer& p = s.printer();
    if (p.has_table()) table_to(s, p.station_um(slot));
    s.move(Axis::tower, lowered_um(p, slot));
    s.move(Axis::carriage, p.carriage.tower_um);
    take(s, slot);
    s.move(Axis::carriage, p.carriage.print_um);
}

std::string_view step_4(const Printer& p) {
    return p.hooks.magnet.present() ? "4 advance, the magnet takes the next vat"
                                    : "4 advance, raise the next vat onto the hooks";
}

void swap_by_tower(Sequence& s, int from_slot, int to_slot, double spray_s) {
    const Printer& p = s.printer();
    const double since_s = push_away(s, from_slot);
    spray(s, to_slot, since_s, spray_s, take_seconds(p) + back_off_seconds(p));
    s.comment(step_4(p));
    s.move(Axis::carriage, p.carriage.tower_um);
    take(s, to_slot);
    pump_off(s);
    s.comment("5 pull it in, dry the part");
    dry_while(s, [&] { s.move(Axis::carriage, p.carriage.print_um); });
}

void store_in_tower(Sequence& s, int slot) {
    const Printer& p = s.printer();
    const double since_s = push_away(s, slot);
    spray(s, slot, since_s, p.cleaning.spray_s, 0);
    pump_off(s);
    dry_while(s, [&] { s.move(Axis::carriage, p.carriage.print_um); });
}

// Walls.

/// A move of the retriever during the spray, in pieces, so that the spray can end on time.
void ride_way_in_strokes(Sequence& s, const RetrieverStep& way, double end_s) {
    constexpr double longest_s = 5;
    const Printer& p = s.printer();
    const Position start = s.position();
    Position to = start;
    to[Axis::tower] = way.lift_um;
    to[Axis::table] = way.rail_um;
    const double seconds = machine::move_seconds(p, start, to, way.feed_mm_s);
    const int pieces = std::max(1, static_cast<int>(std::ceil(seconds / longest_s)));
    for (int i = 1; i <= pieces && s.seconds().total < end_s; ++i) {
        const auto part = [&](Axis axis) {
            return start[axis] + static_cast<int>(static_cast<long long>(to[axis] - start[axis]) * i / pieces);
        };
        oscillate_through(s, {part(Axis::tower), part(Axis::table)}, seconds / pieces);
    }
}

/// The part of the trip that begins before the spray ends at `end_s`; returns the rest.
RetrieverTrip ride_in_strokes(Sequence& s, const RetrieverTrip& trip, double end_s) {
    const Printer& p = s.printer();
    auto step = trip.begin();
    for (; step != trip.end() && s.seconds().total < end_s; ++step) {
        if (step->kind == RetrieverStep::Kind::way) {
            ride_way_in_strokes(s, *step, end_s);
            const bool arrived =
                s.position()[Axis::tower] == step->lift_um && s.position()[Axis::table] == step->rail_um;
            if (!arrived) break;
        } else {
            s.fork(step->kind == RetrieverStep::Kind::fork_out);
            oscillate_through(s, store_at(s), p.wall.fork_s);
        }
    }
    return {step, trip.end()};
}

/// Step 3: sprays for `spray_s` from `since_s`. If the retriever is done by then, the spray ends earlier by the
/// duration of step 4; otherwise returns the rest of its trip, to be done with the pump off.
RetrieverTrip spray_by_wall(Sequence& s, const RetrieverTrip& trip, double since_s, double spray_s, double rest_s) {
    s.comment("3 oscillate over the drain, the retriever is on its way");
    const double end_s = since_s + spray_s;
    RetrieverTrip left = ride_in_strokes(s, trip, end_s);
    const double more_s = end_s - s.seconds().total - rest_s;
    if (left.empty() && more_s > 0) oscillate(s, store_at(s), more_s);
    if (!left.empty()) pump_off(s);
    return left;
}

void load_from_wall(Sequence& s, int slot) {
    const Printer& p = s.printer();
    ride(s, fetch_trip(p, slot));
    s.move(Axis::carriage, p.carriage.tower_um);
    take(s, slot);
    s.move(Axis::carriage, p.carriage.print_um);
}

void swap_by_wall(Sequence& s, int from_slot, int to_slot, double spray_s) {
    const Printer& p = s.printer();
    const double since_s = push_away(s, from_slot);
    RetrieverTrip trip = put_trip(p, from_slot);
    const RetrieverTrip fetch = fetch_trip(p, to_slot);
    trip.insert(trip.end(), fetch.begin(), fetch.end());
    const RetrieverTrip left = spray_by_wall(s, trip, since_s, spray_s, take_seconds(p) + back_off_seconds(p));
    const auto bring = [&] {
        ride(s, left);
        s.comment(step_4(p));
        s.move(Axis::carriage, p.carriage.tower_um);
        take(s, to_slot);
    };
    if (left.empty()) {
        bring();
        pump_off(s);
    }
    dry_while(s, [&] {
        if (!left.empty()) bring();
        s.comment("5 pull it in, dry the part");
        s.move(Axis::carriage, p.carriage.print_um);
    });
}

void store_in_wall(Sequence& s, int slot) {
    const Printer& p = s.printer();
    const double since_s = push_away(s, slot);
    const RetrieverTrip left = spray_by_wall(s, put_trip(p, slot), since_s, p.cleaning.spray_s, 0);
    if (left.empty()) pump_off(s);
    dry_while(s, [&] {
        ride(s, left);
        s.move(Axis::carriage, p.carriage.print_um);
    });
}

// Tables.

/// Moves to the cleaning station, down into it, and up again after `seconds` of bath, ultrasound or spray.
void clean_on_table(Sequence& s, double seconds) {
    const Printer& p = s.printer();
    const int clear_um = s.position()[Axis::platform];
    // The lower end of the part follows from the height at which the platform is clear of the vats.
    const int part_um = clear_um - p.clear_um(0);
    s.activity(Activity::swap);
    s.comment("to the cleaning station, down into it");
    table_to(s, p.table.cleaning_um);
    s.move(Axis::platform, part_um + p.table.bath_gap_um);
    s.pump(true);
    s.activity(Activity::clean);
    if (p.cleaning.stroke_z_um > 0)
        oscillate(s, store_at(s), seconds);
    else
        s.dwell(seconds);
    pump_off(s);
    s.move(Axis::platform, clear_um);
}

void swap_on_table(Sequence& s, int to_slot, double seconds) {
    const Printer& p = s.printer();
    clean_on_table(s, seconds);
    s.comment("bring the next vat, dry the part");
    dry_while(s, [&] { table_to(s, p.station_um(to_slot)); });
}

}  // namespace

void load_vat(Sequence& s, int slot) {
    const Printer& p = s.printer();
    s.activity(Activity::swap);
    if (p.store() == Store::tower) load_from_tower(s, slot);
    if (p.store() == Store::wall) load_from_wall(s, slot);
    if (p.store() == Store::table) table_to(s, p.station_um(slot));
    s.activity(Activity::move);
}

void swap_vat(Sequence& s, int from_slot, int to_slot) {
    const Printer& p = s.printer();
    const double spray_s = p.cleaning_s(vat_of(p, from_slot), vat_of(p, to_slot));
    if (p.store() == Store::tower) swap_by_tower(s, from_slot, to_slot, spray_s);
    if (p.store() == Store::wall) swap_by_wall(s, from_slot, to_slot, spray_s);
    if (p.store() == Store::table) swap_on_table(s, to_slot, spray_s);
}

void store_vat(Sequence& s, int slot) {
    const Printer& p = s.printer();
    if (p.store() == Store::tower) store_in_tower(s, slot);
    if (p.store() == Store::wall) store_in_wall(s, slot);
    if (p.store() == Store::table) {
        clean_on_table(s, p.cleaning.spray_s);
        dry_while(s, [&] { table_to(s, p.station_um(slot)); });
    }
}

void clean_part(Sequence& s, double seconds) {
    const Printer& p = s.printer();
    if (p.store() == Store::table) {
        const int table_um = s.position()[Axis::table];
        clean_on_table(s, seconds);
        dry_while(s, [&] { s.move(Axis::table, table_um); });
    }
    if (!p.has_carriage()) return;
    s.activity(Activity::swap);
    s.comment("clean the part over the drain");
    s.move(Axis::carriage, p.carriage.tower_um - p.carriage.back_off_um);
    s.pump(true);
    s.activity(Activity::clean);
    oscillate(s, store_at(s), seconds);
    pump_off(s);
    dry_while(s, [&] { s.move(Axis::carriage, p.carriage.print_um); });
}

void meet_vat(Sequence& s, int slot) {
    const Printer& p = s.printer();
    if (!p.has_carriage()) return;
    if (p.has_table()) table_to(s, p.station_um(slot));
    s.move(Axis::tower, p.level_um(slot));
}

Sequence standing_at(const machine::Printer& printer, int slot) {
    Sequence s(printer);
    s.mute();
    Position at;
    at[Axis::platform] = printer.push_um(0);
    if (printer.has_carriage()) {
        at[Axis::carriage] = printer.carriage.print_um;
        at[Axis::tower] = printer.level_um(slot);
    }
    at[Axis::table] = printer.station_um(slot);
    s.stand_at(at);
    return s;
}

Seconds load_seconds(const Printer& printer, int slot) {
    Sequence s(printer);
    s.mute();
    for (const Axis axis : machine::homing_order(printer)) s.home(axis);
    const double homed_s = s.seconds().total;
    load_vat(s, slot);
    return {s.seconds().total - homed_s, s.seconds().swap, 0, 0, 0};
}

Seconds swap_seconds(const machine::Printer& printer, int from_slot, int to_slot) {
    Sequence s = standing_at(printer, from_slot);
    swap_vat(s, from_slot, to_slot);
    return s.seconds();
}

}  // namespace pliant::plan
