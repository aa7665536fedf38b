// What the machine must never do, as one state machine over its commands. The planner runs its own G-code through it
// before anyone prints it, and the virtual printer refuses what it forbids.
//
//   - move or light anything before the axis is homed; move beyond an axis' travel
//   - move the carriage while the platform or the part hangs in the vat (but for the shear stroke, and to push a vat
//     away with the part at the height of its brush)
//   - lower the platform into anything but the vat under it, or press the part on the vat's floor
//   - move the tower while a vat is hooked or half in (but for the stroke of the hooks, carriage at the tower; and
//     while the vat lies under the platform, out of the tower, to home it and to bring it level with an empty slot
//     again: so a print goes on after the controller has lost its position)
//   - enter or leave the tower unless a slot stands level (with a vat) or the hooks are clear (without)
//   - push a vat into a slot that is taken
//   - switch a magnet off while it holds a vat anywhere but in its slot, or on with no vat before it; move the carriage
//     with a vat that its magnet does not hold
//   - put the fork of a retriever into the wall but level with a place, empty below a vat or with a vat before an empty
//     place; move lift or rail with it in the wall (but for the stroke that takes a vat off its place); pull it back
//     half-way through that stroke
//   - turn or shift the table unless the platform is clear of everything on it, and no vat is hooked or half in a tower
//   - lower the platform with the table between two stations
//   - light with no vat under the platform, or with the platform above the tallest part, while something moves, or move
//   while the light is on
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
    /// Nothing homed, every vat in its slot, no part on the platform, axes at `start`.
    explicit Interlock(const Printer& printer, const Position& start = {});

    /// All that it knows, to be kept and restored; positions of axes that are not homed mean nothing.
    struct State {
        Position position;
        std::array<bool, axis_count> homed{};
        std::vector<std::optional<int>> slots;  ///< the vat in each slot, by index; of a wall the tray's follows
        std::optional<int> hooked_vat;
        int part_height_um = 0;
        bool pump = false;
        bool magnet = false;
        bool fork_out = false;
    };
    [[nodiscard]] State state() const;
    /// Errors: numbers of slots or vats that the printer does not have.
    [[nodiscard]] static Result<Interlock> restored(const Printer& printer, const State& state);

    /// Each checks one command and carries it out on this state; a refused command changes nothing.
    [[nodiscard]] Status home(Axis axis);
    [[nodiscard]] Status move(const Position& to);
    [[nodiscard]] Status light_on(bool moving);
    [[nodiscard]] Status pump(bool on);
    [[nodiscard]] Status magnet(bool on);
    [[nodiscard]] Status fork(bool out);
    /// A command that switches pump, magnet or fork; any other changes nothing.
    [[nodiscard]] Status output(const Command& command);
    void light_off() { light_ = false; }

    /// The motors were stopped on the way: the axes are here, and must be homed again.
    void stopped_at(const Position& position);

    [[nodiscard]] const Position& position() const { return position_; }
    [[nodiscard]] bool homed(Axis axis) const { return homed_[static_cast<std::size_t>(axis)]; }
    /// Whether every axis that the machine has is homed.
    [[nodiscard]] bool all_homed() const;
    /// Index into Printer::vats of the vat on the hooks; without a tower, of the vat that stands under the platform.
    [[nodiscard]] std::optional<int> hooked_vat() const;
    /// Whether what the vat in use would be lit through, or the drain for what is sprayed, is under the platform.
    [[nodiscard]] bool vat_under_platform() const;
    [[nodiscard]] bool over_drain(const Position& at) const;
    [[nodiscard]] bool pump_runs() const { return pump_; }
    [[nodiscard]] bool magnet_holds() const { return magnet_; }
    [[nodiscard]] bool fork_out() const { return fork_out_; }
    /// The vat on the tray of a wall's retriever, by index.
    [[nodiscard]] std::optional<int> tray_vat() const;
    /// Vat that has been pushed into a slot and let go, by index; nullopt for an empty slot (from 1).
    [[nodiscard]] std::optional<int> vat_in_slot(int slot) const { return slots_[static_cast<std::size_t>(slot - 1)]; }
    [[nodiscard]] int part_height_um() const { return part_height_um_; }
    /// Whether the carriage stands at the tower with the tower within the stroke of the hooks: a vat is being taken or
    /// left.
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
