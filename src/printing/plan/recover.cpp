#include "printing/plan/recover.hpp"

#include <algorithm>

#include "printing/machine/gcode.hpp"
#include "printing/plan/retriever.hpp"
#include "printing/plan/sequence.hpp"
#include "printing/plan/swap.hpp"

namespace pliant::plan {
namespace {

using machine::Axis;
using machine::Interlock;
using machine::Printer;
using machine::Store;

/// After a restart of the controller all outputs are off; a vat before the magnet must be held again.
void wake(Sequence& s, const Interlock& state) {
    for (const std::string& line : machine::preamble(s.printer())) s.command(line);
    s.pump(false);
    s.fans(false);
    s.magnet(state.hooked_vat().has_value());
}

/// Off the vat's floor as gently as in a peel, as far as the position is known.
void rise(Sequence& s, const Interlock& state) {
    const Printer& p = s.printer();
    const int at_um = state.position()[Axis::platform];
    if (!state.homed(Axis::platform) || at_um >= p.clear_um(state.part_height_um())) return;
    s.move(Axis::platform, std::min(at_um + p.platform.lift_um, p.axis(Axis::platform).max_um),
           p.platform.lift_speed_mm_s);
    s.move(Axis::platform, p.axis(Axis::platform).home_um());
}

/// The carriage of a tower comes out from any position, with its vat if it has one. All axes are homed.
void carriage_out(Sequence& s, const Interlock& state) {
    const Printer& p = s.printer();
    if (!p.has_carriage()) return;
    if (state.in_hooks_stroke()) {
        // The next level above the tower's position: a vat on the hooks is at that level, one off the hooks stays in
        // its slot.
        for (int slot = 1; slot <= p.slot_count(); ++slot) {
            const int below_um = p.level_um(slot) - state.position()[Axis::tower];
            const bool here = p.table_at(state.position()[Axis::table], p.station_um(slot));
            if (!here || below_um < 0 || below_um > p.hooks.travel_um) continue;
            s.move(Axis::tower, p.level_um(slot) - (state.hooked_vat() ? 0 : p.hooks.travel_um), p.hooks.speed_mm_s);
        }
    }
    s.move(Axis::carriage, p.carriage.print_um);
}

Status home_all(Sequence& s, const Interlock& state) {
    for (const Axis axis : machine::homing_order(s.printer())) {
        const bool by_hand = s.printer().axis(axis).homes_by_hand;
        if (by_hand && !state.homed(axis))
            return failure(
                "the {} has no limit switch, and the controller has lost its position, so that where it stands is "
                "unknown",
                machine::axis_name(axis, s.printer().store()));
        if (!by_hand) s.home(axis);
    }
    return {};
}

/// From a homed machine with the platform clear of a part of `part_um`: brings the right vat under a clean part.
void bring_right_vat(Sequence& s, const Interrupted& from, std::optional<int> wanted, int part_um) {
    const Printer& p = s.printer();
    std::optional<int> hooked;
    if (p.has_carriage()) hooked = from.state.hooked_vat();
    if (const auto tray = from.state.tray_vat(); tray && !from.state.fork_out()) ride(s, put_trip(p, p.slot_of(*tray)));
    const bool stained = from.last_lit_vat >= 0 && from.last_lit_vat != wanted.value_or(-1);
    if (hooked) {
        meet_vat(s, p.slot_of(*hooked));
        if (hooked != wanted) s.move(Axis::platform, p.push_um(part_um));
        if (!wanted) return store_vat(s, p.slot_of(*hooked));
        if (*hooked != *wanted) swap_vat(s, p.slot_of(*hooked), p.slot_of(*wanted));
        return;
    }
    if (stained) clean_part(s, wanted ? p.cleaning_s(from.last_lit_vat, *wanted) : p.cleaning.spray_s);
    if (wanted) load_vat(s, p.slot_of(*wanted));
}

/// A sequence in the machine's present state, with the platform clear of everything.
Result<Sequence> by_hand(const Interlock& state, const Printer& p) {
    if (!state.all_homed()) return failure("the axes must be homed first");
    if (p.has_carriage() && state.position()[Axis::carriage] != p.carriage.print_um)
        return failure("the carriage must stand at the print position first");
    Sequence s(p);
    s.stand_at(state.position());
    s.command("G90");
    clear_retriever(s, state);
    const int clear_um = p.clear_um(state.part_height_um());
    // The strokes of cleaning go upwards from the platform's position.
    if (state.position()[Axis::platform] < clear_um ||
        state.position()[Axis::platform] > clear_um + p.cleaning.stroke_z_um)
        s.move(Axis::platform, clear_um);
    return s;
}

}  // namespace

Result<std::string> resume_program(const Interrupted& from, const Printer& printer) {
    if (from.on_hooks && printer.hooks.magnet.present())
        return failure(
            "the controller restarted while the carriage was on its way with a vat on its magnet, which has let it go "
            "without power: put the vat into its slot by hand, pull the carriage out, delete the journal and start "
            "the print anew");
    const bool reaches = from.state.fork_out() && !from.state.all_homed();
    if (printer.store() == Store::wall && (from.on_hooks || reaches))
        return failure(
            "the controller restarted while a vat was half-way on the hooks, or the retriever's fork in the wall: pull "
            "the fork back and put every vat into its slot by hand, delete the journal and start the print anew");
    if (from.on_hooks)
        return failure(
            "the controller restarted while the tower stood half-way on the hooks: moving would tear the vat. "
            "Bring the tower by hand until the vat stands in its slot or hangs on the hooks, pull the "
            "carriage out, delete the journal and start the print anew");
    const std::optional<int> wanted = from.finished ? std::nullopt : from.target.hooked_vat();
    Sequence s(printer);
    s.stand_at(from.state.position());
    s.comment("on with an interrupted print: up, home");
    wake(s, from.state);
    rise(s, from.state);
    if (from.state.all_homed()) {
        carriage_out(s, from.state);
        if (from.state.fork_out()) clear_retriever(s, from.state);
    }
    if (Status status = home_all(s, from.state); !status) return tl::unexpected(status.error());
    const int part_um = std::max(from.state.part_height_um(), from.finished ? 0 : from.target.part_height_um());
    s.comment("the right vat, and down");
    s.move(Axis::platform, printer.clear_um(part_um));
    bring_right_vat(s, from, wanted, part_um);
    if (from.finished)
        s.move(Axis::platform, printer.axis(Axis::platform).home_um());
    else
        approach(s, from.target.position()[Axis::platform]);
    s.fence();
    return s.text();
}

Result<std::string> vat_program(const Interlock& state, const Printer& printer, int slot) {
    if (slot != 0 && printer.vat_of_slot(slot) == nullptr) return input_error("slot {} holds no vat", slot);
    Result<Sequence> s = by_hand(state, printer);
    if (!s) return tl::unexpected(s.error());
    const auto hooked = state.hooked_vat();
    const int here = hooked ? printer.slot_of(*hooked) : 0;
    if (here == slot) return s->text();
    if (here == 0 || printer.store() == Store::table) {
        if (slot != 0) load_vat(*s, slot);
    } else {
        if (printer.store() == Store::tower) meet_vat(*s, here);  // it may have been homed since the vat was taken
        if (printer.has_brush()) s->move(Axis::platform, printer.push_um(state.part_height_um()));
        if (slot == 0)
            store_vat(*s, here);
        else
            swap_vat(*s, here, slot);
    }
    s->fence();
    return s->text();
}

Result<std::string> clean_program(const Interlock& state, const Printer& printer, double seconds) {
    if (!(seconds > 0 && seconds <= printer.limits.cleaning_s))
        return input_error("{:g} s of cleaning: {} allows up to {:g} s", seconds, printer.name,
                           printer.limits.cleaning_s);
    if (printer.store() == Store::none) return failure("{} has nothing to clean with", printer.name);
    if (printer.has_carriage() && state.hooked_vat()) return failure("the vat must be put away first");
    Result<Sequence> s = by_hand(state, printer);
    if (!s) return tl::unexpected(s.error());
    clean_part(*s, seconds);
    s->fence();
    return s->text();
}

}  // namespace pliant::plan
