// The virtual printer: speaks Marlin on a stream of bytes, moves on a virtual clock, obeys or refuses by the interlocks
// of the machine, and cures what the projector shows it. The same G-code that drives the real machine drives this one.
//
//     Twin twin(printer);
//     twin.receive("N1 G28 Z*18\n");
//     twin.advance_to(60);
//     twin.take_output();   // "start\n...ok\n"
//
// There is no wall time in it: whoever owns it moves its clock. docs/reference/printer.md says what it knows of Marlin.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "printing/job/job.hpp"
#include "printing/machine/brush.hpp"
#include "printing/machine/gcode.hpp"
#include "printing/machine/printer.hpp"
#include "printing/machine/settling.hpp"
#include "printing/twin/cure.hpp"
#include "printing/twin/fault.hpp"
#include "printing/twin/fluids.hpp"
#include "printing/twin/line_reader.hpp"
#include "printing/twin/motors.hpp"
#include "printing/twin/screen.hpp"
#include "printing/twin/sprayed_part.hpp"

namespace pliant::twin {

/// Which Marlin it is, and what goes wrong.
struct Options {
    bool advanced_ok = false;  ///< `ok N12 P15 B3` instead of `ok`
    double busy_every_s = 2;   ///< `echo:busy: processing` while a command blocks; 0: never. M113 changes it
    std::vector<Fault> faults;
    std::optional<machine::MarlinRelease> release{};  ///< none: what the printer file says of its board
    bool homes_first = false;      ///< NO_MOTION_BEFORE_HOMING: moves of an axis that is not homed are left out
    bool emergency_parser = true;  ///< M112, M108 and M410 act as soon as they arrive
    bool z_sync = false;           ///< NANODLP_Z_SYNC: moves of the platform block and end with `Z_move_comp`
    bool report_fans = false;      ///< `M106 P0 S255` whenever a fan changes
    double wait_every_s = 0;       ///< `wait` while idle (builds with NO_TIMEOUTS); 0: never
    double boot_s = 0;             ///< silence after a reset, before `start`
    /// The projector's mask, of its size: how evenly it lights. None: where the printer file names one, it is unknown
    /// here, and light is taken for even.
    std::optional<job::Image> mask{};
};

/// What happened that must not, or should be known.
struct Log {
    std::vector<std::string> violations;  ///< of the interlocks, with the time
    std::vector<std::string> mishaps;     ///< what broke behind the wire, unknown to the controller
    int swaps = 0;                        ///< another vat was hooked than the one before
    int short_cleanings = 0;  ///< of those, with less spray since the last light than the machine should give
    int exposures = 0;
    long overlit_pixels = 0;  ///< shown more light than a whole pixel needs, in all exposures
    int homings = 0;
    int bad_lines = 0;
    int resets = 0;
    std::vector<double> fan_s;    ///< how long each fan has run
    double lit_while_open_s = 0;  ///< light behind an open door
    bool power_cut = false;       ///< the board's relay has dropped (emergency_line), until a reset
    double pushed_s = 0;          ///< an axis homing to a dead switch pushed against the end of its travel
    int clamped_moves = 0;        ///< that asked for more than an axis' travel, and were cut without a word
    long moves = 0;               ///< carried out; a repeated one changes nothing and is none
    std::uint64_t path = 14695981039346656037ULL;  ///< hash (FNV-1a) of where they went, in order
};

/// Log::path after one more move.
[[nodiscard]] std::uint64_t path_after(std::uint64_t path, const machine::Position& to);

/// What a layer was printed in: shares from 0 to 1.
struct Contamination {
    int top_um = 0;
    int vat = 0;
    double foreign = 0;  ///< of the vat's content that is another resin
    double residue = 0;  ///< of the film of the vat before, past its brush: what cleaning has left on the part
};

class Twin {
public:
    explicit Twin(const machine::Printer& printer, Options options = {});

    /// Bytes from the host, arriving now. What does not fit into the receive buffer is lost, as on the real machine.
    void receive(std::string_view bytes);
    /// Everything said up to now and not yet taken.
    [[nodiscard]] std::string take_output();

    [[nodiscard]] double now() const { return now_s_; }
    /// Somebody has it open, for those who stand outside; light goes through it.
    [[nodiscard]] bool door_is_open() const { return now_s_ >= door_opens_s_ && now_s_ < door_shuts_s_; }
    void advance_to(double seconds);  ///< never back
    /// When the firmware will say or do something next; nullopt while it waits for the host.
    [[nodiscard]] std::optional<double> next_event() const;

    /// Somebody opens the door, or shuts it; nobody tells the controller, which only sees its switch.
    void set_door(bool open);
    /// Somebody fills the vat of a slot up to what the printer file has in it. No such slot: nothing happens.
    void fill_vat(int slot);
    /// Somebody looks after the cleaning solution.
    void care(machine::SolutionCare care) { fluids_.care(care); }

    /// Somebody takes the part away and cleans the platform: the next print begins with an empty block and log.
    void take_part_off();

    void light_on(const job::Image& image);
    void light_off();

    /// Which Marlin it speaks like.
    [[nodiscard]] machine::MarlinRelease release() const {
        return options_.release.value_or(printer_.controller.firmware);
    }
    /// As if the USB port was opened: position and line number are lost, `start` is said.
    void reset();

    [[nodiscard]] const machine::Printer& printer() const { return printer_; }
    /// Where the axes are now; interlock() knows where they go.
    [[nodiscard]] machine::Position motors_position() const { return motors_.position_at(now_s_); }
    [[nodiscard]] const machine::Interlock& interlock() const { return motors_.interlock(); }
    [[nodiscard]] const Log& log() const { return log_; }
    [[nodiscard]] const Screen& screen() const { return screen_; }
    /// The cured block, closed up to now.
    [[nodiscard]] const Cure& cured();
    /// The layers of it that are closed already, while it still grows.
    [[nodiscard]] const std::vector<CuredLayer>& closed_layers() const { return cure_.layers(); }
    [[nodiscard]] const Fluids& fluids() const { return fluids_; }
    /// One entry for each vat of each layer, in the order of printing.
    [[nodiscard]] const std::vector<Contamination>& contamination() const { return contamination_; }

    Twin(const Twin&) = delete;
    Twin& operator=(const Twin&) = delete;

private:
    struct Queued {
        std::string line;
        std::optional<long> number;
    };
    struct Running {
        Queued queued;
        std::optional<machine::Command> command;  ///< nullopt: unknown
        double done_at_s = 0;
        double next_busy_s = 0;
        double reaches_end_s = std::numeric_limits<double>::infinity();  ///< homing to a dead switch: the axis pushes
        bool synced = false;  ///< a move that its end is waited for has been queued
    };

    void say(std::string_view line);
    void say_ok(const Queued& queued, std::string_view data = "");
    void violation(const std::string& what);
    void take_line(std::string line);
    void drain();
    void refuse(const ReceivedLine& line);
    void start_next();
    void finish_running();
    [[nodiscard]] double blocks_until(const machine::Command& command);
    [[nodiscard]] bool is_dead(machine::Axis axis) const;
    void plan_homing(Running& running);
    [[nodiscard]] std::string not_homed(const machine::Command& command) const;
    void execute(const machine::Command& command);
    void execute_move(const machine::Command& command);
    void execute_home(const machine::Command& command);
    void execute_switch(const machine::Command& command);
    void execute_set(const machine::Command& command);
    void execute_other(const machine::Command& command);
    void say_settings();
    void say_soft_endstops();
    void say_switches();
    [[nodiscard]] bool is_pressed(const machine::LimitSwitch& limit) const;
    [[nodiscard]] int slot_of(int vat) const { return printer_.vats[static_cast<std::size_t>(vat)].slot; }
    void spray_until(double at_s);
    void switch_pump(bool on, double at_s);
    void switch_latch(const machine::Command& command, double at_s);
    void miss_vat(const std::optional<int>& tray);
    void drop_vat();
    void switch_fans(const machine::Command& command, double at_s);
    void open_door();
    void note_vat(std::optional<int> before);
    void count_swap(int vat);
    void miss_steps(const machine::Position& from, const machine::Position& to);
    void change_vat_part(int vat);
    void boot();
    void user_continues();
    void execute_query(const machine::Command& command);
    void mishap(const std::string& what);
    [[nodiscard]] int vat_under_light() const;
    [[nodiscard]] double idle_event() const;
    [[nodiscard]] machine::Position clamped(machine::Position to);
    void kill(std::string_view why);
    void let_go();
    void note_push();
    void outputs_off();
    void quick_stop();
    /// The fault of that kind for the n-th time something happens; nullptr: none.
    [[nodiscard]] const Fault* fault_at(Fault::Kind kind, int n) const;
    [[nodiscard]] bool fault_hits(Fault::Kind kind, int n) const { return fault_at(kind, n) != nullptr; }
    [[nodiscard]] std::vector<machine::Axis> axes_to_home(const machine::Command& command) const;

    const machine::Printer printer_;
    const Options options_;
    const Screen screen_;
    Motors motors_;
    Cure cure_;
    Fluids fluids_;
    SprayedPart sprayed_{printer_};
    std::vector<Contamination> contamination_;
    Log log_;
    double now_s_ = 0;

    LineReader reader_{release() != machine::MarlinRelease::v2_1_1};
    std::string arriving_;  ///< the line whose end has not arrived
    std::string buffer_;    ///< received, waiting for a place in the queue
    std::deque<Queued> queue_;
    std::optional<Running> running_;
    std::string output_;
    bool dead_ = false;                ///< killed: reads nothing, says nothing
    std::optional<double> lets_go_s_;  ///< killed in motion: the steppers go on until then
    double held_until_s_ = 0;          ///< after a quick stop the queue waits
    double idle_limit_s_ = 120;
    bool soft_endstops_ = true;  ///< M211
    double feed_mm_s_ = 0;
    double busy_every_s_ = 2;
    double next_wait_s_ = 0;
    std::optional<double> boots_at_s_;  ///< silent until then
    double stalled_until_s_ = 0;
    int refuse_more_ = 0;  ///< good lines that a resend loop still refuses
    int lines_ = 0, oks_ = 0, resends_ = 0, bytes_ = 0, moves_ = 0, unhooked_ = 0, pump_starts_ = 0;

    std::array<int, machine::axis_count> slip_um_{};  ///< how far each axis is from where the controller thinks
    int stuck_vat_ = -1;                              ///< on hooks that do not let go
    int missed_vat_ = -1;                             ///< on hooks that did not catch it, or fallen off them
    int left_vat_ = -1;                               ///< stays in the wall, though the retriever thinks it has it
    bool fork_stuck_ = false;                         ///< stays in the next time that a vat changes its place
    int takes_ = 0, reaches_ = 0;                     ///< of the magnet; of the fork, out
    machine::Settling settling_{printer_};
    int part_vat_ = -1;  ///< whose resin clings to the part
    double residue_ = 0;
    machine::BrushWatch brush_{printer_};
    bool pump_works_ = true;
    bool drew_air_ = false;
    std::optional<Runs> shown_;
    double shown_since_s_ = 0;
    int shown_vat_ = -1;
    double door_opens_s_ = -1, door_shuts_s_ = -1;  ///< the last time
    std::vector<double> fan_since_s_;               ///< below 0: off
    bool pump_on_ = false;
    double pump_since_s_ = 0;
    double sprayed_s_ = 0;  ///< since the last light
    int last_vat_ = -1;
};

}  // namespace pliant::twin
