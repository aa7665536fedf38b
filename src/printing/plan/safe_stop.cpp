#include "printing/plan/safe_stop.hpp"

#include <algorithm>

#include "printing/plan/retriever.hpp"
#include "printing/plan/sequence.hpp"
#include "printing/plan/swap.hpp"

namespace pliant::plan {
namespace {

using machine::Axis;
using machine::Interlock;
using machine::Printer;

Sequence from(const Interlock& state, const Printer& p) {
    Sequence s(p);
    s.stand_at(state.position());
    return s;
}

/// The slot that the tower is level with, or a part of the hooks' stroke below.
int slot_before_carriage(const Interlock& state, const Printer& p) {
    for (int slot = 1; slot <= p.slot_count(); ++slot) {
        const int below = p.level_um(slot) - state.position()[Axis::tower];
        const bool here = p.table_at(state.position()[Axis::table], p.station_um(slot));
        if (here && below >= 0 && below <= p.hooks.travel_um) return slot;
    }
    return 0;
}

/// The retriever of a wall puts away its vat; for a vat under the platform it goes to the bay.
void ready_retriever(Sequence& s, const Interlock& state) {
    const Printer& p = s.printer();
    const bool near = state.position()[Axis::carriage] > p.carriage.tower_um - p.carriage.back_off_um;
    if (near) return;  // it is at the bay, with an empty fork
    clear_retriever(s, state);
    if (state.hooked_vat()) meet_vat(s, 1);
}

/// Stores the vat on the tray, whether an emptied carriage has left it there or it was there before.
void put_from_tray(Sequence& s, const Interlock& state) {
    const Printer& p = s.printer();
    const bool near = state.position()[Axis::carriage] > p.carriage.tower_um - p.carriage.back_off_um;
    const auto vat = state.hooked_vat() ? state.hooked_vat() : near ? state.tray_vat() : std::nullopt;
    if (vat) ride(s, put_trip(p, p.slot_of(*vat)));
}

/// The slot into which the vat on the hooks goes: the one that the tower is level with or, if that is none or not
/// empty, as after homing the tower, its own, which the tower brings.
int slot_for_vat(Sequence& s, const Interlock& state, int vat) {
    const Printer& p = s.printer();
    const machine::Position& at = state.position();
    const int here = slot_before_carriage(state, p);
    const bool is_ready =
        here > 0 && (at[Axis::carriage] == p.carriage.tower_um || at[Axis::tower] == p.level_um(here));
    if (is_ready && !state.vat_in_slot(here)) return here;
    const int own = p.slot_of(vat);
    meet_vat(s, own);
    return own;
}

/// A vat on the hooks goes into the tower or back to the wall; a carriage without one only comes out.
void empty_carriage(Sequence& s, const Interlock& state) {
    const Printer& p = s.printer();
    const bool wall = p.store() == machine::Store::wall;
    if (wall) ready_retriever(s, state);
    const auto hooked = state.hooked_vat();
    const int slot = wall ? 1 : hooked ? slot_for_vat(s, state, *hooked) : slot_before_carriage(state, p);
    if (hooked) s.move(Axis::carriage, p.carriage.tower_um);
    const bool in_tower = s.position()[Axis::carriage] == p.carriage.tower_um;
    if (in_tower) s.magnet(false);
    if (in_tower && slot > 0) s.move(Axis::tower, p.level_um(slot) - p.hooks.travel_um, p.hooks.speed_mm_s);
    s.move(Axis::carriage, p.carriage.print_um);
    if (wall) put_from_tray(s, state);
}

void switch_off(Sequence& s) {
    s.pump(false);
    s.fans(false);
}

}  // namespace

std::string cancel_program(const Interlock& state, const Printer& printer) {
    Sequence s = from(state, printer);
    s.comment("cancelled: everything off, platform up, the vat back into its slot");
    s.command("G90");
    switch_off(s);
    if (!state.homed(Axis::platform)) return s.text();
    const int up_um = printer.axis(Axis::platform).home_um();
    s.move(Axis::platform, up_um);
    if (printer.has_carriage() && state.all_homed()) empty_carriage(s, state);
    s.fence();
    return s.text();
}

Pause hold_program(const Interlock& state, const Printer& printer) {
    Sequence s = from(state, printer);
    s.comment("held: everything off, nothing moves");
    switch_off(s);
    s.fence();
    Sequence back = from(state, printer);
    back.comment("on");
    if (state.pump_runs()) back.pump(true);
    back.fence();
    return {s.text(), back.text()};
}

Pause pause_program(const Interlock& state, const Printer& printer) {
    Sequence s = from(state, printer);
    s.comment("paused: the platform waits clear of the vat");
    s.command("G90");
    switch_off(s);
    const machine::Position before = state.position();
    const int clear_um = printer.clear_um(state.part_height_um());
    if (state.homed(Axis::platform)) s.move(Axis::platform, std::max(before[Axis::platform], clear_um));
    s.fence();
    Sequence back = from(state, printer);
    back.stand_at(s.position());
    back.comment("on: the platform goes back");
    const machine::Platform& platform = printer.platform;
    const int slow_from_um = before[Axis::platform] + platform.approach_um;
    if (back.position()[Axis::platform] > slow_from_um) back.move(Axis::platform, slow_from_um);
    back.move_to(before, platform.approach_speed_mm_s);
    back.fence();
    if (state.pump_runs()) back.pump(true);
    return {s.text(), back.text()};
}

}  // namespace pliant::plan
