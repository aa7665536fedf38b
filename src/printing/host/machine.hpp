// The controller, guarded by interlocks and journal: no command is sent that the machine's rules forbid, or that a
// later host could not reconstruct.
#pragma once

#include <functional>
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
    /// The state after the last command.
    [[nodiscard]] const machine::Interlock& state() const { return at_.lock; }
    void stand(const machine::Interlock& state) { at_.lock = state; }
    [[nodiscard]] const Firmware& firmware() const { return firmware_; }

    /// From here on everything sent is recorded; nullptr: no recording. The journal must outlive that.
    void keep(Journal* journal);

    /// Connects and reads the firmware's capabilities; lines are numbered from `base`.
    [[nodiscard]] Status connect(long base);

    /// Sends step `step` of program `program` (see GoFact). Homing is awaited, for no longer than the travel takes: if
    /// the switch is dead the machine is halted. Then the axis backs off its switch and returns: a switch that stays
    /// pressed is stuck. Before a vat is taken, left or carried, the machine comes to rest and the journal records it.
    /// Errors: forbidden by the interlocks, journal, link.
    [[nodiscard]] Status send(long program, std::size_t step, std::string_view command);
    /// Sends a program that is not part of the job, and waits until it is done. `before_each` is called before every
    /// command; an error of it ends the program there.
    [[nodiscard]] Status run(std::string_view program, const std::function<Status()>& before_each = {});
    /// Waits until the machine stands still.
    [[nodiscard]] Status rest();
    /// The same, and checks that the controller's reported position is the expected one. A controller that cannot
    /// report is trusted.
    [[nodiscard]] Status rest_in_place();

    /// After M410: queries the position at rest. All axes then count as not homed, since steps may have been lost.
    [[nodiscard]] Status stand_where_stopped();

    /// Step `step` of the job is an exposure, which begins now: until the next command the controller only gets
    /// questions. After run() that holds as well. Before there are too many of them to prove that no other program has
    /// used the controller, the journal records where it stands.
    void stay_for(std::size_t step) { place_ = Place{0, step}; }

    // Switches: a machine whose file lists none and that has no door is not queried.

    /// Waits until the machine stands still, sends M119 and checks the answer against the position. Errors: those of
    /// machine::check_switches().
    [[nodiscard]] Status look_at_switches();
    /// Sends M119, at most four times a second and only if nothing is in progress; hear() receives the answer.
    [[nodiscard]] Status ask_for_door();
    /// Sends M119 to an idle machine, at most once a second, and waits for the answer.
    [[nodiscard]] Status ask_for_switches();
    /// Handles a line from the controller.
    void hear(std::string_view line);
    /// Last known state; nullopt: not yet known, or there is no switch.
    [[nodiscard]] std::optional<bool> door_open() const { return door_open_; }
    /// Last known states of the limit switches that the printer file lists, in its order; unknown ones are left out.
    [[nodiscard]] std::vector<machine::SwitchReading> limit_switches() const;

    [[nodiscard]] Status light_on() { return at_.lock.light_on(false); }
    void light_off() { at_.lock.light_off(); }

private:
    [[nodiscard]] bool has_switches() const { return !printer_.limit_switches.empty() || printer_.door.present(); }
    [[nodiscard]] Status wait_for_homing(std::string_view command);
    [[nodiscard]] Status after_homing(std::string_view command);
    [[nodiscard]] Status leave_switch(machine::Axis axis);
    [[nodiscard]] Status note_go(long program, std::size_t step, const machine::Interlock& before, long most);
    [[nodiscard]] Status write_go(long program, std::size_t step, const machine::Interlock& before, long most);
    [[nodiscard]] Status keep_place();

    Clock& clock_;
    const machine::Printer& printer_;
    Link link_;
    Firmware firmware_;
    machine::Followed at_;
    Journal* journal_ = nullptr;
    std::optional<bool> door_open_;
    std::vector<std::optional<bool>> pressed_;  ///< per listed limit switch
    double switches_asked_s_ = 0;
    bool noted_ = false;   ///< the journal knows the line number of the next step
    long noted_line_ = 0;  ///< of the journal's last record
    /// A step before which no command is left to carry out.
    struct Place {
        long program;
        std::size_t step;
    };
    std::optional<Place> place_;
};

/// Whether two states agree in what a resuming host needs: the vat on the hooks, and the place of the carriage.
[[nodiscard]] bool same_phase(const machine::Printer& printer, const machine::Interlock& a,
                              const machine::Interlock& b);

/// Whether `answer` to M114 names all axes of the printer, and whether all homed ones are where the state says.
enum class Position { unread, agrees, differs };
[[nodiscard]] Position compare_position(const machine::Printer& printer, const machine::Interlock& state,
                                        std::string_view answer);

}  // namespace pliant::host
