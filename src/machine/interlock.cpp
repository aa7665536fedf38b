#include "machine/interlock.hpp"

#include <algorithm>

namespace pliant::machine {
namespace {

double mm(int um) {
    return um / 1000.0;
}

}  // namespace

Interlock::Interlock(const Printer& printer, const Position& start)
    : printer_(&printer), position_(start), slots_(static_cast<std::size_t>(printer.tower.slots)) {
    for (std::size_t i = 0; i < printer.vats.size(); ++i) {
        slots_[static_cast<std::size_t>(printer.vats[i].slot - 1)] = static_cast<int>(i);
    }
}

bool Interlock::in_print_window(int carriage_um) const {
    const Carriage& c = printer_->carriage;
    return carriage_um >= c.print_um && carriage_um <= c.print_um + c.shear_um;
}

/// The slot whose level is at most one hook stroke above `tower_um`.
std::optional<int> Interlock::slot_in_hook_stroke(int tower_um) const {
    for (int slot = 1; slot <= printer_->tower.slots; ++slot) {
        const int below = printer_->level_um(slot) - tower_um;
        if (below >= 0 && below <= printer_->hooks.travel_um) return slot;
    }
    return std::nullopt;
}

std::optional<int> Interlock::level_slot(int tower_um) const {
    const auto slot = slot_in_hook_stroke(tower_um);
    return slot && printer_->level_um(*slot) == tower_um ? slot : std::nullopt;
}

bool Interlock::hooks_clear(int tower_um) const {
    const auto slot = slot_in_hook_stroke(tower_um);
    return slot && printer_->level_um(*slot) - printer_->hooks.travel_um == tower_um;
}

Status Interlock::home(Axis axis) {
    if (light_) return failure("homing while the light is on");
    const bool platform_up = homed(Axis::platform) && position_[Axis::platform] >= printer_->clear_um(part_height_um_);
    if (axis != Axis::platform && !platform_up) {
        return failure("homing the {} before the platform is homed and clear of the vat", axis_name(axis));
    }
    if (axis == Axis::tower && (!homed(Axis::carriage) || hooked_vat_)) {
        return failure("homing the tower before the carriage stands back without a vat");
    }
    if (axis == Axis::carriage && hooked_vat_ && !in_print_window(position_[Axis::carriage])) {
        return failure("homing the carriage with a vat in the tower");
    }
    position_[axis] = printer_->axis(axis).home_um();
    homed_[static_cast<std::size_t>(axis)] = true;
    return {};
}

Status Interlock::check_travel(const Position& to) const {
    for (const Axis axis : all_axes) {
        if (to[axis] == position_[axis]) continue;
        const AxisSpec& spec = printer_->axis(axis);
        if (!homed(axis)) return failure("the {} moves before it is homed", axis_name(axis));
        if (to[axis] < spec.min_um || to[axis] > spec.max_um) {
            return failure("the {} would go to {:.3f} mm, outside its travel of {:.3f} to {:.3f} mm", axis_name(axis),
                           mm(to[axis]), mm(spec.min_um), mm(spec.max_um));
        }
    }
    return {};
}

/// Platform and part hang in the vat below the clear height: then the carriage may only shear.
Status Interlock::check_platform(const Position& to) const {
    const int lowest = std::min(to[Axis::platform], position_[Axis::platform]);
    if (!homed(Axis::platform)) {
        return to[Axis::carriage] == position_[Axis::carriage]
                   ? Status{}
                   : failure("the carriage moves before the platform is homed");
    }
    if (lowest >= printer_->clear_um(part_height_um_)) return {};
    if (!in_print_window(to[Axis::carriage]) || !in_print_window(position_[Axis::carriage])) {
        return failure("the platform is down at {:.3f} mm (clear from {:.3f} mm) while the carriage is not at print",
                       mm(lowest), mm(printer_->clear_um(part_height_um_)));
    }
    if (to[Axis::platform] < part_height_um_) {
        return failure("the platform at {:.3f} mm would press a part of {:.3f} mm on the vat's floor",
                       mm(to[Axis::platform]), mm(part_height_um_));
    }
    return {};
}

Status Interlock::check_tower(const Position& to) const {
    const int from_um = position_[Axis::tower];
    const int to_um = to[Axis::tower];
    if (from_um == to_um) return {};
    const int nearest = std::max(to[Axis::carriage], position_[Axis::carriage]);
    if (!hooked_vat_ && nearest <= printer_->carriage.tower_um - printer_->carriage.back_off_um) return {};
    const bool at_tower =
        to[Axis::carriage] == printer_->carriage.tower_um && position_[Axis::carriage] == printer_->carriage.tower_um;
    const auto slot = slot_in_hook_stroke(from_um);
    if (at_tower && slot && slot == slot_in_hook_stroke(to_um)) return {};
    return failure("the tower moves while {}",
                   hooked_vat_ ? "a vat is hooked to the carriage" : "the carriage stands at it");
}

Status Interlock::check_carriage(const Position& to) const {
    if (to[Axis::carriage] == position_[Axis::carriage]) return {};
    const int nearest = std::max(to[Axis::carriage], position_[Axis::carriage]);
    const bool touches_tower = hooked_vat_ ? !in_print_window(nearest)
                                           : nearest > printer_->carriage.tower_um - printer_->carriage.back_off_um;
    if (!touches_tower) return {};
    if (!homed(Axis::tower)) return failure("the carriage goes to the tower before that is homed");
    if (!hooked_vat_) {
        return hooks_clear(position_[Axis::tower]) ? Status{}
                                                   : failure("the carriage meets the tower with the hooks not clear");
    }
    const auto slot = level_slot(position_[Axis::tower]);
    if (!slot) return failure("the carriage moves a vat while no slot is level with it");
    if (vat_in_slot(*slot)) return failure("slot {} is taken already", *slot);
    return {};
}

/// At the tower, a level slot gives its vat to the hooks; a lowered one keeps it.
void Interlock::take_or_leave_vat() {
    if (position_[Axis::carriage] != printer_->carriage.tower_um) return;
    const auto slot = slot_in_hook_stroke(position_[Axis::tower]);
    if (!slot) return;
    auto& place = slots_[static_cast<std::size_t>(*slot - 1)];
    if (!hooked_vat_ && level_slot(position_[Axis::tower])) {
        hooked_vat_ = place;
        place.reset();
    } else if (hooked_vat_ && hooks_clear(position_[Axis::tower])) {
        place = hooked_vat_;
        hooked_vat_.reset();
    }
}

Status Interlock::move(const Position& to) {
    if (light_) return failure("a move while the light is on");
    for (const auto check :
         {&Interlock::check_travel, &Interlock::check_platform, &Interlock::check_tower, &Interlock::check_carriage}) {
        if (Status status = (this->*check)(to); !status) return status;
    }
    position_ = to;
    take_or_leave_vat();
    return {};
}

Status Interlock::light_on(bool moving) {
    if (moving) return failure("light while the machine moves");
    if (!homed(Axis::platform) || !homed(Axis::carriage)) return failure("light before the machine is homed");
    if (!hooked_vat_ || position_[Axis::carriage] != printer_->carriage.print_um) {
        return failure("light with no vat under the platform");
    }
    light_ = true;
    part_height_um_ = std::max(part_height_um_, position_[Axis::platform]);
    return {};
}

void Interlock::stopped_at(const Position& position) {
    position_ = position;
    homed_.fill(false);
}

}  // namespace pliant::machine
