// The controller under the eye of the interlocks and of the journal: no command goes out that the machine's rules
// forbid, and none that a later host could not reckon with.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/host/journal.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/machine/follow.hpp"
#include "printing/machine/printer.hpp"
#include "printing/machine/switches.hpp"
#include "printing/wire/link.hpp"

namespace pliant::host {

/// Wire, clock and printer must outlive it.
class Machine {
public:
    Machine(Wire& wire, Clock& clock, const machine::Printer& printer, const LinkOptions& options);

    [[nodiscard]] Link& link() { return link_; }
    [[nodiscard]] const Link& link() const { return link_; }
    /// Where it stands after the last command.
    [[nodiscard]] const machine::Interlock& state() const { return at_.lock; }
    void stand(const machine::Interlock& state) { at_.lock = state; }
    [[nodiscard]] const Firmware& firmware() const { return firmware_; }

    /// What is sent from here on is kept; nullptr: no more. The journal must outlive that.
    void keep(Journal* journal);

    /// Connects and learns what the firmware can; lines are numbered from `base` on.
    [[nodiscard]] Status connect(long base);

    /// Sends step `step` of program `program` (see GoFact). Homing is waited for, not longer than its way takes: past a
    /// switch that is dead the machine is halted. Then the axis leaves its switch and comes back: one that stays
    /// pressed is stuck. Where a vat is taken, left or carried, the machine first comes to rest and the
    /// journal says so. Errors: forbidden by the interlocks, journal, link.
    [[nodiscard]] Status send(long program, std::size_t step, std::string_view command);
    /// Sends a program that is not the job's, and waits until it is done.
    [[nodiscard]] Status run(std::string_view program);
    /// Waits until the machine stands still.
    [[nodiscard]] Status rest();
    /// The same, and the controller says that it is where it has been sent. A controller that cannot say is believed.
    [[nodiscard]] Status rest_in_place();

    /// After M410: asks where it has come to rest. Nothing counts as homed any more: steps may have been lost.
    [[nodiscard]] Status stand_where_stopped();

    // Switches: nothing is asked of a machine whose file lists none and that has no door.

    /// Waits until the machine stands still, asks M119 and holds the answer against where it stands. Errors: what
    /// machine::check_switches() says.
    [[nodiscard]] Status look_at_switches();
    /// Asks M119, four times a second at most and only if nothing is under way; hear() gets the answer.
    [[nodiscard]] Status ask_for_door();
    /// Asks M119 of a machine that stands idle, once a second at most, and waits for the answer.
    [[nodiscard]] Status ask_for_switches();
    /// Takes a line that the controller has said.
    void hear(std::string_view line);
    /// As last heard; nullopt: not yet, or there is no switch.
    [[nodiscard]] std::optional<bool> door_open() const { return door_open_; }
    /// The limit switches that the printer file lists, in its order, as last heard; those not yet heard are left out.
    [[nodiscard]] std::vector<machine::SwitchReading> limit_switches() const;

    [[nodiscard]] Status light_on() { return at_.lock.light_on(false); }
    void light_off() { at_.lock.light_off(); }

private:
    [[nodiscard]] bool has_switches() const { return !printer_.limit_switches.empty() || printer_.door.present(); }
    [[nodiscard]] Status wait_for_homing(std::string_view command);
    [[nodiscard]] Status after_homing(std::string_view command);
    [[nodiscard]] Status leave_switch(machine::Axis axis);
    [[nodiscard]] Status note_go(long program, std::size_t step, const machine::Interlock& before, long most);

    Clock& clock_;
    const machine::Printer& printer_;
    Link link_;
    Firmware firmware_;
    machine::Followed at_;
    Journal* journal_ = nullptr;
    std::optional<bool> door_open_;
    std::vector<std::optional<bool>> pressed_;  ///< of every listed limit switch
    double switches_asked_s_ = 0;
    bool noted_ = false;  ///< the journal knows which line the next step will have
};

/// What of a state matters to a host that has to go on from it: the vat on the hooks, and where the carriage is.
[[nodiscard]] bool same_phase(const machine::Printer& printer, const machine::Interlock& a,
                              const machine::Interlock& b);

/// Whether `answer` to M114 names all axes of the printer, and whether all homed ones are where the state says.
enum class Position { unread, agrees, differs };
[[nodiscard]] Position compare_position(const machine::Printer& printer, const machine::Interlock& state,
                                        std::string_view answer);

}  // namespace pliant::host
