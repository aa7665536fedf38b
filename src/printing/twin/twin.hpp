// The virtual printer: speaks Marlin on a stream of bytes, moves on a virtual clock, obeys or refuses by the interlocks
// of the machine, and cures what the projector shows it. The same G-code drives it and the real machine.
//
//     Twin twin(printer);
//     twin.receive("N1 G28 Z*18\n");
//     twin.advance_to(60);
//     twin.take_output();   // "start\n...ok\n"
//
// It does not use real time: the owner advances its clock. docs/reference/printer.md lists the supported parts of
// Marlin.
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

/// Release of Marlin, and faults.
struct Options {
    bool advanced_ok = false;  ///< `ok N12 P15 B3` instead of `ok`
    double busy_every_s = 2;   ///< `echo:busy: processing` while a command blocks; 0: never. M113 changes it
    std::vector<Fault> faults;
    std::optional<machine::MarlinRelease> release{};  ///< nullopt: as in the printer file
    bool homes_first = false;      ///< NO_MOTION_BEFORE_HOMING: moves of an axis that is not homed are ignored
    bool emergency_parser = true;  ///< M112, M108 and M410 act on arrival
    bool z_sync = false;           ///< NANODLP_Z_SYNC: moves of the platform block and are confirmed by `Z_move_comp`
    bool report_fans = false;      ///< `M106 P0 S255` whenever a fan changes
    double wait_every_s = 0;       ///< `wait` while idle (builds with NO_TIMEOUTS); 0: never
    double boot_s = 0;             ///< silence after a reset, before `start`
    /// The projector's mask, of its size. None: a mask named in the printer file is unknown here, and the light counts
    /// as even.
    std::optional<job::Image> mask{};
};

/// Forbidden or remarkable events.
struct Log {
    std::vector<std::string> violations;  ///< of the interlocks, with the time
    std::vector<std::string> mishaps;     ///< failures in the machine, unknown to the controller
    int swaps = 0;                        ///< number of times another vat than the previous one was hooked
    int short_cleanings = 0;              ///< swaps with less spray since the last exposure than required
    int exposures = 0;
    long overlit_pixels = 0;  ///< given more light than a whole pixel needs, over all exposures
    int homings = 0;
    int bad_lines = 0;
    int resets = 0;
    std::vector<double> fan_s;    ///< running time of each fan
    double lit_while_open_s = 0;  ///< exposure time with the door open
    bool power_cut = false;       ///< the board's relay has dropped (emergency_line), until a reset
    double pushed_s = 0;          ///< time an axis that homes to a dead switch pushed against the end of its travel
    int clamped_moves = 0;        ///< beyond an axis' travel, and silently limited to it
    long moves = 0;               ///< executed; a repeated one changes nothing and does not count
    std::uint64_t path = 14695981039346656037ULL;  ///< hash (FNV-1a) of their targets, in order
};

/// Log::path after one more move.
[[nodiscard]] std::uint64_t path_after(std::uint64_t path, const machine::Position& to);

/// The contamination that a layer was printed with: fractions from 0 to 1.
struct Contamination {
    int top_um = 0;
    int vat = 0;
    double foreign = 0;  ///< of the vat's content that is another resin
    double residue = 0;  ///< of the previous vat's film, after its brush: left on the part by cleaning
};

class Twin {
public:
    explicit Twin(const machine::Printer& printer, Options options = {});

    /// Bytes from the host, arriving now. Bytes that do not fit into the receive buffer are lost, as on the real
    /// machine.
    void receive(std::string_view bytes);
    /// All output so far that has not been taken.
    [[nodiscard]] std::string take_output();

    [[nodiscard]] double now() const { return now_s_; }
    /// Actual state of the door, open to observers outside; light passes through it.
    [[nodiscard]] bool door_is_open() const { return now_s_ >= door_opens_s_ && now_s_ < door_shuts_s_; }
    void advance_to(double seconds);  ///< must not decrease
    /// When the firmware will send or do something next; nullopt while it waits for the host.
    [[nodiscard]] std::optional<double> next_event() const;

    /// Opens or shuts the door; the controller only sees its switch.
    void set_door(bool open);
    /// Refills the vat of a slot to the level in the printer file. Does nothing if there is no such slot.
    void fill_vat(int slot);
    /// Maintenance of the cleaning solution.
    void care(machine::SolutionCare care) { fluids_.care(care); }

    /// Removes the part and cleans the platform: the next print begins with an empty block and log.
    void take_part_off();

    void light_on(const job::Image& image);
    void light_off();

    /// The release of Marlin it behaves like.
    [[nodiscard]] machine::MarlinRelease release() const {
        return options_.release.value_or(printer_.controller.firmware);
    }
    /// As when the USB port is opened: position and line number are lost, `start` is sent.
    void reset();

    [[nodiscard]] const machine::Printer& printer() const { return printer_; }
    /// The present position of the axes; interlock() has their targets.
    [[nodiscard]] machine::Position motors_position() const { return motors_.position_at(now_s_); }
    [[nodiscard]] const machine::Interlock& interlock() const { return motors_.interlock(); }
    [[nodiscard]] const Log& log() const { return log_; }
    /// The faults whose occasion has not come, as in fault_text().
    [[nodiscard]] std::vector<std::string> missed_faults() const;
    [[nodiscard]] const Screen& screen() const { return screen_; }
    /// The cured block, closed up to now.
    [[nodiscard]] const Cure& cured();
    /// Its layers that are closed already, while it still grows.
    [[nodiscard]] const std::vector<CuredLayer>& closed_layers() const { return cure_.layers(); }
    /// The layer after them, see Cure.
    [[nodiscard]] std::optional<CuredLayer> open_layer() const { return cure_.open_layer(); }
    [[nodiscard]] std::size_t open_lights() const { return cure_.open_lights(); }
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
        std::optional<machine::Command> command;  ///< nullopt: unknown command
        double done_at_s = 0;
        double next_busy_s = 0;
        double reaches_end_s = std::numeric_limits<double>::infinity();  ///< homing to a dead switch: when the axis
                                                                         ///< reaches the end of its travel
        bool synced = false;  ///< the move whose end is awaited has been queued
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
    [[nodiscard]] int slot_of(int vat) const { return printer_.slot_of(vat); }
    void spray_until(double at_s);
    void switch_pump(bool on, double at_s);
    void switch_latch(const machine::Command& command, double at_s);
    void miss_vat(const std::optional<int>& tray);
    void lose_power();
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
    /// The fault of that kind for the n-th occurrence; nullptr: none.
    [[nodiscard]] const Fault* fault_at(Fault::Kind kind, int n) const;
    [[nodiscard]] bool fault_hits(Fault::Kind kind, int n) const { return fault_at(kind, n) != nullptr; }
    [[nodiscard]] std::vector<machine::Axis> axes_to_home(const machine::Command& command) const;

    const machine::Printer printer_;
    const Options options_;
    const Screen screen_;
    mutable std::vector<bool> occurred_;  ///< by fault: whether it was asked for when it was due
    Motors motors_;
    Cure cure_;
    Fluids fluids_;
    SprayedPart sprayed_{printer_};
    std::vector<Contamination> contamination_;
    Log log_;
    double now_s_ = 0;

    LineReader reader_{release() != machine::MarlinRelease::v2_1_1};
    std::string arriving_;  ///< the incomplete line
    std::string buffer_;    ///< received, waiting for room in the queue
    std::deque<Queued> queue_;
    std::optional<Running> running_;
    std::string output_;
    bool dead_ = false;                ///< killed: reads and sends nothing
    std::optional<double> lets_go_s_;  ///< killed in motion: the motors run until then
    double held_until_s_ = 0;          ///< the queue waits until then after a quick stop
    double idle_limit_s_ = 120;
    bool soft_endstops_ = true;  ///< M211
    double feed_mm_s_ = 0;
    double busy_every_s_ = 2;
    double next_wait_s_ = 0;
    std::optional<double> boots_at_s_;  ///< silent until then
    double stalled_until_s_ = 0;
    int refuse_more_ = 0;  ///< valid lines still to be refused by a resend loop
    int lines_ = 0, oks_ = 0, resends_ = 0, bytes_ = 0, moves_ = 0, unhooked_ = 0, pump_starts_ = 0;

    std::array<int, machine::axis_count> slip_um_{};  ///< deviation of each axis from the controller's position
    int stuck_vat_ = -1;                              ///< on hooks that do not release
    int missed_vat_ = -1;                             ///< on hooks that did not catch it, or fallen off them
    int left_vat_ = -1;                               ///< left in the wall, though the retriever is assumed to have it
    bool fork_stuck_ = false;                         ///< stays in at the next transfer of a vat
    int takes_ = 0, reaches_ = 0;                     ///< number of uses of the magnet, and of extensions of the fork
    machine::Settling settling_{printer_};
    int part_vat_ = -1;  ///< whose resin is on the part
    double residue_ = 0;
    machine::BrushWatch brush_{printer_};
    bool pump_works_ = true;
    bool drew_air_ = false;
    std::optional<Runs> shown_;
    double shown_since_s_ = 0;
    int shown_vat_ = -1;
    double door_opens_s_ = -1, door_shuts_s_ = -1;  ///< the last time
    std::vector<double> fan_since_s_;               ///< since when each fan runs; below 0: off
    bool pump_on_ = false;
    double pump_since_s_ = 0;
    double sprayed_s_ = 0;  ///< since the last exposure
    int last_vat_ = -1;
};

}  // namespace pliant::twin
