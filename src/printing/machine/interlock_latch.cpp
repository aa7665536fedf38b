// Latches of a vat: the magnet of the carriage, and the fork of a wall's retriever.
#include "printing/machine/interlock.hpp"

namespace pliant::machine {

Status Interlock::output(const Command& command) {
    if (const auto on = switched(printer_->pump, command)) return pump(*on);
    if (const auto on = switched(printer_->hooks.magnet.coil, command)) return magnet(*on);
    if (const auto out = switched(printer_->wall.fork, command)) return fork(*out);
    return {};
}

// The magnet.

/// Switched off, it releases its vat where that is; switched on, it takes the vat before it. After a stop the axes are
/// where they stopped, although they count as not homed: a vat that then stands in its slot can be taken and released.
Status Interlock::magnet(bool on) {
    const bool at_store = position_[Axis::carriage] == printer_->carriage.tower_um;
    const auto slot = at_store ? level_slot(position_) : std::nullopt;
    auto* place = slot ? &slots_[static_cast<std::size_t>(*slot - 1)] : nullptr;
    if (on) {
        // A magnet that was switched off by a stop of the firmware takes the same vat again.
        if (!hooked_vat_ && (place == nullptr || !*place))
            return failure("the magnet is switched on with no vat before it");
        if (!hooked_vat_) std::swap(hooked_vat_, *place);
    } else if (hooked_vat_) {
        if (place == nullptr) return failure("the magnet is switched off while it holds a vat outside its slot");
        std::swap(hooked_vat_, *place);
    }
    magnet_ = on;
    return {};
}

/// A vat that is not held must not be dragged along.
Status Interlock::check_hold(const Position& to) const {
    const bool loose = hooked_vat_ && printer_->hooks.magnet.present() && !magnet_;
    if (!loose || to[Axis::carriage] == position_[Axis::carriage]) return {};
    return failure("the carriage moves with a vat that its magnet does not hold");
}

// The retriever of a wall.

std::optional<int> Interlock::tray_vat() const {
    return printer_->store() == Store::wall ? slots_.back() : std::nullopt;
}

/// The slot in front of the tray, which is level with it or at most the lift-off stroke below.
std::optional<int> Interlock::place_in_wall(const Position& at) const {
    for (int slot = 1; slot <= printer_->slot_count(); ++slot) {
        const int below = printer_->row_um(slot) - at[Axis::tower];
        const bool here = at[Axis::table] == printer_->column_um(slot);
        if (here && below >= 0 && below <= printer_->wall.lift_off_um) return slot;
    }
    return std::nullopt;
}

/// The carriage is back, or under the platform with its vat: the retriever may move freely.
bool Interlock::retriever_free(const Position& to) const {
    return tower_free(to) || (vat_out_of_tower() && in_print_window(to[Axis::carriage]));
}

Status Interlock::fork(bool out) {
    if (out == fork_out_) return {};
    if (!homed(Axis::tower) || !homed(Axis::table)) return failure("the fork moves before lift and rail are homed");
    if (out && !retriever_free(position_)) return failure("the fork moves while the carriage stands at the tray");
    const auto slot = place_in_wall(position_);
    if (!slot) return failure("the fork goes into the wall where no place is before it");
    const int below = printer_->row_um(*slot) - position_[Axis::tower];
    const bool laden = tray_vat().has_value();
    if (below != (laden ? 0 : printer_->wall.lift_off_um)) {
        return laden ? failure("the fork moves with a vat that is not level with slot {}", *slot)
                     : failure("the empty fork moves at slot {} with the lift not lowered", *slot);
    }
    if (out && laden && vat_in_slot(*slot)) return failure("slot {} is taken already", *slot);
    if (out && !laden && !vat_in_slot(*slot)) return failure("slot {} is empty: there is nothing to take", *slot);
    fork_out_ = out;
    return {};
}

/// With the fork in the wall, only the stroke that takes a vat off its place or puts it there is allowed.
Status Interlock::check_fork(const Position& to) const {
    if (!fork_out_) return {};
    if (to[Axis::table] != position_[Axis::table]) return failure("the rail moves with the fork in the wall");
    if (to[Axis::tower] == position_[Axis::tower]) return {};
    const auto slot = place_in_wall(position_);
    if (slot && slot == place_in_wall(to)) return {};
    return failure("the lift leaves its place with the fork in the wall");
}

/// When raised level with a place the fork takes its vat; when lowered, it leaves its own there.
void Interlock::take_or_leave_in_wall() {
    const auto slot = fork_out_ ? place_in_wall(position_) : std::nullopt;
    if (!slot) return;
    auto& place = slots_[static_cast<std::size_t>(*slot - 1)];
    auto& tray = slots_.back();
    const int below = printer_->row_um(*slot) - position_[Axis::tower];
    if ((below == 0 && !tray) || (below == printer_->wall.lift_off_um && tray && !place)) std::swap(place, tray);
}

}  // namespace pliant::machine
