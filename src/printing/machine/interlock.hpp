// What the machine must never do, as a state machine over its commands. The planner checks its own G-code with it
// before printing, and the virtual printer refuses what it forbids.
//
//   - move or expose before the axis is homed; move beyond an axis' travel
//   - move the carriage while the platform or the part is in the vat (except for the shear stroke, and to push a vat
//     away with the part at the height of its brush)
//   - lower the platform into anything but the vat under it, or press the part on the vat's floor
//   - move the tower while a vat is hooked or half in (except for the stroke of the hooks, carriage at the tower; and,
//     while the vat is under the platform and out of the tower, to home it and to bring it level with an empty slot
//     again: this is how a print resumes after the controller has lost its position)
//   - enter or leave the tower unless a slot is level (with a vat) or the hooks are clear (without)
//   - push a vat into an occupied slot
//   - switch a magnet off while it holds a vat anywhere but in its slot, or on with no vat before it; move the carriage
//     with a vat that its magnet does not hold
//   - put the fork of a retriever into the wall unless level with a place, empty below a vat or with a vat before an
//     empty place; move lift or rail with the fork in the wall (except for the stroke that takes a vat off its place);
//     pull the fork back half-way through that stroke
//   - turn or shift the table unless the platform is clear of everything on it, and no vat is hooked or half in a tower
//   - lower the platform with the table between two stations
//   - expose with no vat under the platform, with the platform above the tallest part, or while something moves; move
//     during an exposure
//   - run the pump anywhere but over the drain of the cleaning vat, or move away from there while it runs
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/gcode.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// Positions are those after the last accepted command. A value: a copy is a snapshot. The printer must outlive it.
class Interlock {
public:
    /// Initially nothing is homed, every vat is in its slot, no part is on the platform, axes are at `start`.
    explicit Interlock(const Printer& printer, const Position& start = {});

    /// The complete state, for saving and restoring; positions of axes that are not homed are meaningless.
    struct State {
        Position position;
        std::array<bool, axis_count> homed{};
        std::vector<std::optional<int>> slots;  ///< index of the vat in each slot; with a wall, followed by that on the
                                                ///< tray
        std::optional<int> hooked_vat;
        int part_height_um = 0;
        bool pump = false;
        bool magnet = false;
        bool fork_out = false;
    };
    [[nodiscard]] State state() const;
    /// Errors: slots or vats that the printer does not have.
    [[nodiscard]] static Result<Interlock> restored(const Printer& printer, const State& state);

    /// Each checks one command and applies it to this state; a refused command changes nothing.
    [[nodiscard]] Status home(Axis axis);
    [[nodiscard]] Status move(const Position& to);
    [[nodiscard]] Status light_on(bool moving);
    [[nodiscard]] Status pump(bool on);
    [[nodiscard]] Status magnet(bool on);
    [[nodiscard]] Status fork(bool out);
    /// A command that switches pump, magnet or fork; any other changes nothing.
    [[nodiscard]] Status output(const Command& command);
    void light_off() { light_ = false; }

    /// The motors were stopped midway: the axes are here, and must be homed again.
    void stopped_at(const Position& position);

    [[nodiscard]] const Position& position() const { return position_; }
    [[nodiscard]] bool homed(Axis axis) const { return homed_[static_cast<std::size_t>(axis)]; }
    /// Whether every axis that the machine has is homed.
    [[nodiscard]] bool all_homed() const;
    /// Index into Printer::vats of the vat on the hooks; without a tower, of the vat under the platform.
    [[nodiscard]] std::optional<int> hooked_vat() const;
    /// Whether the exposure window of the vat in use, or the drain for spraying, is under the platform.
    [[nodiscard]] bool vat_under_platform() const;
    [[nodiscard]] bool over_drain(const Position& at) const;
    [[nodiscard]] bool pump_runs() const { return pump_; }
    [[nodiscard]] bool magnet_holds() const { return magnet_; }
    [[nodiscard]] bool fork_out() const { return fork_out_; }
    /// Index of the vat on the tray of a wall's retriever.
    [[nodiscard]] std::optional<int> tray_vat() const;
    /// Index of the vat that was put into a slot (from 1) and released; nullopt for an empty slot.
    [[nodiscard]] std::optional<int> vat_in_slot(int slot) const { return slots_[static_cast<std::size_t>(slot - 1)]; }
    [[nodiscard]] int part_height_um() const { return part_height_um_; }
    /// Whether the carriage is at the tower and the tower within the stroke of the hooks: a vat is being taken or left.
    [[nodiscard]] bool in_hooks_stroke() const;

private:
    [[nodiscard]] std::string_view name(Axis axis) const { return axis_name(axis, printer_->store()); }
    [[nodiscard]] Status check_travel(const Position& to) const;
    [[nodiscard]] Status check_platform(const Position& to) const;
    [[nodiscard]] Status check_tower(const Position& to) const;
    [[nodiscard]] Status check_carriage(const Position& to) const;
    [[nodiscard]] bool brushes(const Position& to, int lowest_um) const;
    [[nodiscard]] bool in_print_window(int carriage_um) const;
    [[nodiscard]] Status check_carriage_in_vat(const Position& to) const;
    [[nodiscard]] Status check_table(const Position& to) const;
    [[nodiscard]] Status check_pump(const Position& to) const;
    [[nodiscard]] bool tower_free(const Position& to) const;
    [[nodiscard]] bool vat_out_of_tower() const;
    [[nodiscard]] bool takes_vat_back(const Position& to) const;
    [[nodiscard]] std::optional<int> vat_at_station(int table_um) const;
    [[nodiscard]] std::optional<int> slot_in_hook_stroke(const Position& at) const;
    [[nodiscard]] std::optional<int> level_slot(const Position& at) const;
    [[nodiscard]] bool hooks_clear(const Position& at) const;
    [[nodiscard]] std::optional<int> place_in_wall(const Position& at) const;
    [[nodiscard]] bool retriever_free(const Position& to) const;
    [[nodiscard]] Status check_fork(const Position& to) const;
    [[nodiscard]] Status check_hold(const Position& to) const;
    void take_or_leave_vat();
    void take_or_leave_in_wall();

    const Printer* printer_;
    Position position_;
    std::array<bool, axis_count> homed_{};
    std::vector<std::optional<int>> slots_;
    std::optional<int> hooked_vat_;
    int part_height_um_ = 0;
    bool light_ = false;
    bool pump_ = false;
    bool magnet_ = false;
    bool fork_out_ = false;
};

}  // namespace pliant::machine
