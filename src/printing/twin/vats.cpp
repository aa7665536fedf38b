// The actual places of the virtual printer's vats, whatever its controller assumes, and the carry-over of resin by the
// part.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "printing/twin/twin.hpp"

namespace pliant::twin {
namespace {

using machine::Axis;
using machine::Command;

constexpr int most_slip_um = 500;  // of carriage, table or tower: with a larger error transfers fail

}  // namespace

/// Handles a move that has put a vat on the hooks, under the platform, or away.
void Twin::note_vat(std::optional<int> before) {
    const auto vat = interlock().hooked_vat();
    if (vat == before) return;
    const double brushed = brush_.wiped() ? printer_.brushed_share() : 0;
    brush_.reset();
    if (before) {
        if (part_vat_ == *before && cure_.section_mm2() > 0) {
            cure_.take_ml(*before, fluids_.leave(*before, cure_.section_mm2(), brushed));
            residue_ = 1;
        }
        if (fault_hits(Fault::Kind::stuck_hook, ++unhooked_) && stuck_vat_ < 0) {
            stuck_vat_ = *before;
            mishap(fmt::format("the vat of slot {} stays on the hooks", slot_of(*before)));
        }
    }
    if (!vat) return;
    const bool missed = std::abs(slip_um_[static_cast<std::size_t>(Axis::tower)]) > most_slip_um;
    const bool weak = printer_.hooks.magnet.present() && fault_hits(Fault::Kind::weak_magnet, ++takes_);
    missed_vat_ = missed || weak || *vat == left_vat_ ? *vat : -1;
    if (missed) mishap("the hooks do not catch the vat: the tower is off");
    if (weak) mishap(fmt::format("the magnet does not hold the vat of slot {}", slot_of(*vat)));
    count_swap(*vat);
}

/// Counts swaps, and those with too little cleaning between the last exposure and the new vat.
void Twin::count_swap(int vat) {
    if (vat == last_vat_) return;
    if (last_vat_ >= 0) {
        ++log_.swaps;
        // The rise of the hooks, during which the pump still runs, is only queued here; a magnet is only switched.
        const bool spraying = pump_on_ && pump_works_;
        const double taken_s = std::max(now_s_, motors_.done_at()) + printer_.hooks.magnet.engage_s;
        const double sprayed = sprayed_s_ + (spraying ? taken_s - pump_since_s_ : 0);
        if (!printer_.pump.on.empty() && sprayed < 0.99 * printer_.cleaning_s(last_vat_, vat)) ++log_.short_cleanings;
    }
    last_vat_ = vat;
}

/// Magnet and fork switch when the moves before them are done, and take their time.
void Twin::switch_latch(const Command& c, double at_s) {
    const std::optional<int> vat = interlock().hooked_vat();
    const bool was_out = interlock().fork_out();
    if (Status status = motors_.interlock().output(c); !status) return violation(status.error().message);
    settling_.note(c, at_s);
    note_vat(vat);
    if (was_out || !interlock().fork_out() || !fault_hits(Fault::Kind::stuck_fork, ++reaches_)) return;
    mishap("the retriever's fork stays in");
    fork_stuck_ = true;
}

/// Records the vat that a fork which stayed in has not taken off its place, or has not put there.
void Twin::miss_vat(const std::optional<int>& tray) {
    const std::optional<int> now = interlock().tray_vat();
    if (now == tray) return;
    if (!interlock().fork_out() || !fork_stuck_) return;
    fork_stuck_ = false;
    left_vat_ = now ? *now : *tray;
    mishap(fmt::format("the vat of slot {} is not where the retriever thinks", slot_of(left_vat_)));
}

/// Without power the motors stop, and the magnet releases its vat: it stays in its slot, or under the platform, and
/// falls anywhere else.
void Twin::lose_power() {
    const machine::Switch& coil = printer_.hooks.magnet.coil;
    const bool needs_power = !coil.on.empty() && !machine::on_without_power(coil);
    const bool held = needs_power && interlock().magnet_holds();
    motors_.release(now_s_);
    const std::optional<int> vat = interlock().hooked_vat();
    if (!held || !vat) return;
    const machine::Carriage& c = printer_.carriage;
    const int at_um = interlock().position()[Axis::carriage];
    if (at_um >= c.print_um && at_um <= c.print_um + c.shear_um) return;
    if (motors_.interlock().magnet(false)) return note_vat(vat);
    missed_vat_ = *vat;
    mishap(fmt::format("the vat of slot {} falls: its magnet has no power", slot_of(*vat)));
}

/// Index of the vat that actually is under the platform; -1: none is in place.
int Twin::vat_under_light() const {
    const int hooked = interlock().hooked_vat().value_or(-1);
    const auto slip = [&](machine::Axis axis) { return std::abs(slip_um_[static_cast<std::size_t>(axis)]); };
    if (slip(machine::Axis::carriage) > most_slip_um || slip(machine::Axis::table) > most_slip_um) return -1;
    if (hooked >= 0 && hooked == missed_vat_) return -1;
    return stuck_vat_ >= 0 ? stuck_vat_ : hooked;
}

/// The part enters a vat with the cleaning residue of the previous one.
void Twin::change_vat_part(int vat) {
    if (part_vat_ != vat) {
        cure_.take_ml(vat, -fluids_.enter(vat, cure_.left_ml()[static_cast<std::size_t>(vat)]));
        part_vat_ = vat;
    }
    const int top_um = interlock().position()[machine::Axis::platform];
    const bool known =
        !contamination_.empty() && contamination_.back().top_um == top_um && contamination_.back().vat == vat;
    if (!known) contamination_.push_back({top_um, vat, fluids_.foreign_share(vat), residue_});
}

void Twin::fill_vat(int slot) {
    const machine::Vat* vat = printer_.vat_of_slot(slot);
    if (vat == nullptr) return;
    const int index = static_cast<int>(vat - printer_.vats.data());
    const double left_ml = std::max(0.0, cure_.left_ml()[static_cast<std::size_t>(index)]);
    if (left_ml >= vat->fill_ml) return;
    fluids_.pour(index, left_ml, vat->fill_ml - left_ml);
    cure_.set_level_ml(index, vat->fill_ml);
}

}  // namespace pliant::twin
