#include "printing/machine/interlock.hpp"

#include <algorithm>

namespace pliant::machine {
namespace {

double mm(int um) {
    return um / 1000.0;
}

}  // namespace

Interlock::Interlock(const Printer& printer, const Position& start)
    : printer_(&printer),
      position_(start),
      slots_(static_cast<std::size_t>(printer.slot_count() + (printer.store() == Store::wall ? 1 : 0))) {
    for (std::size_t i = 0; i < printer.vats.size(); ++i) {
        slots_[static_cast<std::size_t>(printer.vats[i].slot - 1)] = static_cast<int>(i);
    }
}

Interlock::State Interlock::state() const {
    return {position_, homed_, slots_, hooked_vat_, part_height_um_, pump_, magnet_, fork_out_};
}

Result<Interlock> Interlock::restored(const Printer& printer, const State& state) {
    Interlock lock(printer, state.position);
    const int vats = static_cast<int>(printer.vats.size());
    const auto known = [&](const std::optional<int>& vat) { return !vat || (*vat >= 0 && *vat < vats); };
    const bool fits = state.slots.size() == lock.slots_.size() && known(state.hooked_vat) &&
                      std::all_of(state.slots.begin(), state.slots.end(), known);
    if (!fits) return input_error("slots or vats that {} does not have", printer.name);
    lock.homed_ = state.homed;
    lock.slots_ = state.slots;
    lock.hooked_vat_ = state.hooked_vat;
    lock.part_height_um_ = state.part_height_um;
    lock.pump_ = state.pump;
    lock.magnet_ = state.magnet;
    lock.fork_out_ = state.fork_out;
    return lock;
}

bool Interlock::all_homed() const {
    return std::all_of(all_axes.begin(), all_axes.end(),
                       [&](Axis axis) { return !printer_->axis(axis).present() || homed(axis); });
}

bool Interlock::in_print_window(int carriage_um) const {
    const Carriage& c = printer_->carriage;
    return carriage_um >= c.print_um && carriage_um <= c.print_um + c.shear_um;
}

/// The slot in front of the carriage whose level is at most one hook stroke above the tower's position. With a wall,
/// the index after the last slot: the tray, if it is in front of the carriage.
std::optional<int> Interlock::slot_in_hook_stroke(const Position& at) const {
    if (printer_->store() == Store::wall) {
        const int below = printer_->wall.bay_lift_um - at[Axis::tower];
        const bool here = at[Axis::table] == printer_->wall.bay_rail_um && !fork_out_;
        return here && below >= 0 && below <= printer_->hooks.travel_um ? std::optional(printer_->slot_count() + 1)
                                                                        : std::nullopt;
    }
    const int slots = printer_->tower.slots;
    for (int first = 1; first <= printer_->slot_count(); first += slots) {
        if (!printer_->table_at(at[Axis::table], printer_->station_um(first))) continue;
        for (int slot = first; slot < first + slots; ++slot) {
            const int below = printer_->level_um(slot) - at[Axis::tower];
            if (below >= 0 && below <= printer_->hooks.travel_um) return slot;
        }
    }
    return std::nullopt;
}

std::optional<int> Interlock::level_slot(const Position& at) const {
    const auto slot = slot_in_hook_stroke(at);
    return slot && printer_->level_um(*slot) == at[Axis::tower] ? slot : std::nullopt;
}

bool Interlock::hooks_clear(const Position& at) const {
    const auto slot = slot_in_hook_stroke(at);
    return slot && printer_->level_um(*slot) - printer_->hooks.travel_um == at[Axis::tower];
}

std::optional<int> Interlock::vat_at_station(int table_um) const {
    for (int slot = 1; slot <= printer_->slot_count(); ++slot) {
        if (printer_->table_at(table_um, printer_->station_um(slot))) return vat_in_slot(slot);
    }
    return std::nullopt;
}

std::optional<int> Interlock::hooked_vat() const {
    if (printer_->has_carriage()) return hooked_vat_;
    return vat_at_station(position_[Axis::table]);
}

bool Interlock::vat_under_platform() const {
    if (!hooked_vat()) return false;
    return !printer_->has_carriage() || position_[Axis::carriage] == printer_->carriage.print_um;
}

bool Interlock::over_drain(const Position& at) const {
    switch (printer_->store()) {
        case Store::tower:
        case Store::wall:
            return at[Axis::carriage] >= printer_->drain_begin_um() &&
                   at[Axis::carriage] <= printer_->carriage.tower_um;
        case Store::table:
            return printer_->table_at(at[Axis::table], printer_->table.cleaning_um);
        case Store::none:
            break;
    }
    return false;
}

Status Interlock::home(Axis axis) {
    if (light_) return failure("homing while the light is on");
    if (pump_) return failure("homing while the pump runs");
    const bool platform_up = homed(Axis::platform) && position_[Axis::platform] >= printer_->clear_um(part_height_um_);
    if (axis != Axis::platform && !platform_up) {
        return failure("homing the {} before the platform is homed and clear of the vat", name(axis));
    }
    const bool stores = axis == Axis::tower || (axis == Axis::table && printer_->has_carriage());
    if (stores && (!homed(Axis::carriage) || !(tower_free(position_) || vat_out_of_tower()))) {
        return failure("homing the {} before the carriage stands back without a vat", name(axis));
    }
    if (stores && fork_out_) return failure("homing the {} with the fork in the wall", name(axis));
    const bool held = hooked_vat_ && !in_print_window(position_[Axis::carriage]) && !level_slot(position_);
    if (axis == Axis::carriage && hooked_vat_ && printer_->hooks.magnet.present() && !magnet_) {
        return failure("homing the carriage with a vat that its magnet does not hold");
    }
    if (axis == Axis::carriage && held) {
        return failure("homing the carriage with a vat in the tower, which does not stand level");
    }
    position_[axis] = printer_->axis(axis).home_um();
    homed_[static_cast<std::size_t>(axis)] = true;
    return {};
}

Status Interlock::check_travel(const Position& to) const {
    for (const Axis axis : all_axes) {
        if (to[axis] == position_[axis]) continue;
        const AxisSpec& spec = printer_->axis(axis);
        if (!homed(axis)) return failure("the {} moves before it is homed", name(axis));
        if (to[axis] < spec.min_um || to[axis] > spec.max_um) {
            return failure("the {} would go to {:.3f} {}, outside its travel of {:.3f} to {:.3f}", name(axis),
                           mm(to[axis]), spec.rotary ? "deg" : "mm", mm(spec.min_um), mm(spec.max_um));
        }
    }
    return {};
}

/// Whether the platform (clear, or not homed) and everything beside it can move past each other.
Status Interlock::check_platform(const Position& to) const {
    const bool beside = to[Axis::carriage] != position_[Axis::carriage] || to[Axis::table] != position_[Axis::table];
    if (!homed(Axis::platform)) {
        return beside ? Status(failure("the carriage moves before the platform is homed")) : Status{};
    }
    const int lowest = std::min(to[Axis::platform], position_[Axis::platform]);
    if (lowest >= printer_->clear_um(part_height_um_) || brushes(to, lowest)) return {};
    if (Status status = check_carriage_in_vat(to); !status) return status;
    if (to[Axis::platform] < part_height_um_) {
        return failure("the platform at {:.3f} mm would press a part of {:.3f} mm on the vat's floor",
                       mm(to[Axis::platform]), mm(part_height_um_));
    }
    return {};
}

/// The part is low enough for the brush, below the rims of the vats: only the vat in use may pass under it, on its way
/// into the tower.
bool Interlock::brushes(const Position& to, int lowest_um) const {
    if (!printer_->has_brush() || lowest_um < printer_->push_um(part_height_um_)) return false;
    if (to[Axis::table] != position_[Axis::table]) return false;
    const int way_um = to[Axis::carriage] - position_[Axis::carriage];
    if (way_um != 0) return way_um > 0 && hooked_vat_;
    return to[Axis::platform] >= position_[Axis::platform] || to[Axis::carriage] == printer_->carriage.tower_um;
}

/// Platform and part are in the vat, below the clear height: the carriage may only shear, the table must not move.
Status Interlock::check_carriage_in_vat(const Position& to) const {
    const double lowest = mm(std::min(to[Axis::platform], position_[Axis::platform]));
    const double clear = mm(printer_->clear_um(part_height_um_));
    if (printer_->has_carriage()) {
        if (in_print_window(to[Axis::carriage]) && in_print_window(position_[Axis::carriage])) return {};
        return failure("the platform is down at {:.3f} mm (clear from {:.3f} mm) while the carriage is not at print",
                       lowest, clear);
    }
    if (to[Axis::table] != position_[Axis::table]) {
        return failure("the platform is down at {:.3f} mm (clear from {:.3f} mm) while the table moves", lowest, clear);
    }
    if (vat_under_platform() || over_drain(position_)) return {};
    return failure("the platform would go down to {:.3f} mm (clear from {:.3f} mm) with the table between two stations",
                   lowest, clear);
}

/// No vat is hooked and the carriage is back, now and at the end of the move.
bool Interlock::tower_free(const Position& to) const {
    const int nearest = std::max(to[Axis::carriage], position_[Axis::carriage]);
    return !hooked_vat_ && nearest <= printer_->carriage.tower_um - printer_->carriage.back_off_um;
}

/// The vat in use is under the platform.
bool Interlock::vat_out_of_tower() const {
    return hooked_vat_ && in_print_window(position_[Axis::carriage]);
}

/// The tower moves level with an empty slot for the vat under the platform.
bool Interlock::takes_vat_back(const Position& to) const {
    const auto slot = level_slot(to);
    return vat_out_of_tower() && in_print_window(to[Axis::carriage]) && slot && !vat_in_slot(*slot);
}

bool Interlock::in_hooks_stroke() const {
    return printer_->has_carriage() && printer_->hooks.travel_um > 0 &&
           position_[Axis::carriage] == printer_->carriage.tower_um && slot_in_hook_stroke(position_).has_value();
}

Status Interlock::check_tower(const Position& to) const {
    if (position_[Axis::tower] == to[Axis::tower]) return {};
    if (printer_->store() == Store::wall ? retriever_free(to) : tower_free(to) || takes_vat_back(to)) return {};
    const bool at_tower = to[Axis::carriage] == printer_->carriage.tower_um &&
                          position_[Axis::carriage] == printer_->carriage.tower_um &&
                          to[Axis::table] == position_[Axis::table];
    const auto slot = slot_in_hook_stroke(position_);
    if (at_tower && slot && slot == slot_in_hook_stroke(to)) return {};
    return failure("the {} moves while {}", name(Axis::tower),
                   hooked_vat_ ? "a vat is hooked to the carriage" : "the carriage stands at it");
}

Status Interlock::check_table(const Position& to) const {
    if (position_[Axis::table] == to[Axis::table] || !printer_->has_carriage() || tower_free(to)) return {};
    // On the way back to the tower that the vat came from; the slot is determined by the tower's move.
    if (vat_out_of_tower() && in_print_window(to[Axis::carriage])) return {};
    return failure("the {} moves while {}", name(Axis::table),
                   hooked_vat_ ? "a vat is hooked to the carriage" : "the carriage stands before it");
}

Status Interlock::check_carriage(const Position& to) const {
    if (to[Axis::carriage] == position_[Axis::carriage]) return {};
    const int nearest = std::max(to[Axis::carriage], position_[Axis::carriage]);
    const bool touches_tower = hooked_vat_ ? !in_print_window(nearest)
                                           : nearest > printer_->carriage.tower_um - printer_->carriage.back_off_um;
    if (!touches_tower) return {};
    const std::string_view store = printer_->store() == Store::wall ? "retriever" : "tower";
    if (!homed(Axis::tower)) return failure("the carriage goes to the {} before that is homed", store);
    if (!hooked_vat_) {
        return hooks_clear(position_) ? Status{} : failure("the carriage meets the {} with the hooks not clear", store);
    }
    const auto slot = level_slot(position_);
    if (!slot) return failure("the carriage moves a vat while no slot is level with it");
    if (!vat_in_slot(*slot)) return {};
    if (printer_->store() == Store::wall) return failure("the tray holds a vat already");
    return failure("slot {} is taken already", *slot);
}

Status Interlock::check_pump(const Position& to) const {
    if (!pump_ || over_drain(to)) return {};
    return failure("a move away from the drain while the pump runs");
}

Status Interlock::pump(bool on) {
    if (on && !over_drain(position_)) return failure("the pump starts while the part is not over the drain");
    pump_ = on;
    return {};
}

/// At the tower, a level slot passes its vat to the hooks; a lowered one keeps it.
void Interlock::take_or_leave_vat() {
    if (!printer_->has_carriage() || printer_->hooks.magnet.present() ||
        position_[Axis::carriage] != printer_->carriage.tower_um)
        return;
    const auto slot = slot_in_hook_stroke(position_);
    if (!slot) return;
    auto& place = slots_[static_cast<std::size_t>(*slot - 1)];
    if (!hooked_vat_ && level_slot(position_)) {
        hooked_vat_ = place;
        place.reset();
    } else if (hooked_vat_ && hooks_clear(position_)) {
        place = hooked_vat_;
        hooked_vat_.reset();
    }
}

Status Interlock::move(const Position& to) {
    if (light_) return failure("a move while the light is on");
    for (const auto check :
         {&Interlock::check_travel, &Interlock::check_platform, &Interlock::check_tower, &Interlock::check_table,
          &Interlock::check_fork, &Interlock::check_hold, &Interlock::check_carriage, &Interlock::check_pump}) {
        if (Status status = (this->*check)(to); !status) return status;
    }
    position_ = to;
    take_or_leave_vat();
    take_or_leave_in_wall();
    return {};
}

Status Interlock::light_on(bool moving) {
    if (moving) return failure("light while the machine moves");
    for (const Axis axis : {Axis::platform, Axis::carriage, Axis::table}) {
        if (printer_->axis(axis).present() && !homed(axis)) return failure("light before the machine is homed");
    }
    if (!vat_under_platform()) return failure("light with no vat under the platform");
    if (position_[Axis::platform] > printer_->platform.build_height_um) {
        return failure("light with the platform at {:.3f} mm, above all that it builds", mm(position_[Axis::platform]));
    }
    light_ = true;
    part_height_um_ = std::max(part_height_um_, position_[Axis::platform]);
    return {};
}

void Interlock::stopped_at(const Position& position) {
    position_ = position;
    homed_.fill(false);
    pump_ = false;
    magnet_ = false;
}

}  // namespace pliant::machine
