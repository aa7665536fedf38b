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

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "job/job.hpp"
#include "machine/gcode.hpp"
#include "machine/printer.hpp"
#include "twin/cure.hpp"
#include "twin/line_reader.hpp"
#include "twin/motors.hpp"

namespace pliant::twin {

/// Something that goes wrong on demand, once.
struct Fault {
    enum class Kind {
        corrupt_byte,  ///< a bit of the n-th received line flips
        lose_line,     ///< the n-th received line never arrives
        lose_ok,       ///< the n-th `ok` is not heard
        lose_resend,   ///< the n-th `Resend:` is not heard
        reset,         ///< the controller restarts when the n-th line arrives
    };
    Kind kind = Kind::corrupt_byte;
    int n = 1;
};

struct Options {
    bool advanced_ok = false;  ///< `ok N12 P15 B3` instead of `ok`
    double busy_every_s = 2;   ///< `echo:busy: processing` while a command blocks
    std::vector<Fault> faults;
};

/// What happened that must not, or should be known.
struct Log {
    std::vector<std::string> violations;  ///< of the interlocks, with the time
    int swaps = 0;                        ///< another vat was hooked than the one before
    int short_cleanings = 0;  ///< of those, with less spray since the last light than the machine should give
    int exposures = 0;
    int homings = 0;
    int bad_lines = 0;
    int resets = 0;
};

class Twin {
public:
    explicit Twin(const machine::Printer& printer, Options options = {});

    /// Bytes from the host, arriving now. What does not fit into the receive buffer is lost, as on the real machine.
    void receive(std::string_view bytes);
    /// Everything said up to now and not yet taken.
    [[nodiscard]] std::string take_output();

    [[nodiscard]] double now() const { return now_s_; }
    void advance_to(double seconds);  ///< never back
    /// When the firmware will say or do something next; nullopt while it waits for the host.
    [[nodiscard]] std::optional<double> next_event() const;

    void light_on(const job::Image& image);
    void light_off();

    /// As if the USB port was opened: position and line number are lost, `start` is said.
    void reset();

    [[nodiscard]] const machine::Printer& printer() const { return printer_; }
    [[nodiscard]] const machine::Interlock& interlock() const { return motors_.interlock(); }
    [[nodiscard]] const Log& log() const { return log_; }
    /// The cured block, closed up to now.
    [[nodiscard]] const Cure& cured();

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
    };

    void say(std::string_view line);
    void say_ok(const Queued& queued);
    void violation(const std::string& what);
    void take_line(std::string line);
    void drain();
    void refuse(const ReceivedLine& line);
    void start_next();
    void finish_running();
    [[nodiscard]] double blocks_until(const machine::Command& command);
    void execute(const machine::Command& command, const Queued& queued);
    void execute_move(const machine::Command& command);
    void execute_home(const machine::Command& command);
    void execute_switch(const machine::Command& command);
    void execute_set(const machine::Command& command);
    void execute_other(const machine::Command& command);
    void note_vat();
    void kill();
    void quick_stop();
    [[nodiscard]] bool fault_hits(Fault::Kind kind, int n) const;
    [[nodiscard]] std::vector<machine::Axis> axes_to_home(const machine::Command& command) const;

    const machine::Printer printer_;
    const Options options_;
    Motors motors_;
    Cure cure_;
    Log log_;
    double now_s_ = 0;

    LineReader reader_;
    std::string arriving_;  ///< the line whose end has not arrived
    std::string buffer_;    ///< received, waiting for a place in the queue
    std::deque<Queued> queue_;
    std::optional<Running> running_;
    std::string output_;
    bool dead_ = false;
    double idle_limit_s_ = 120;
    double feed_mm_s_ = 0;
    int lines_ = 0, oks_ = 0, resends_ = 0;

    std::optional<job::Image> shown_;
    double shown_since_s_ = 0;
    int shown_vat_ = -1;
    bool pump_on_ = false;
    double pump_since_s_ = 0;
    double sprayed_s_ = 0;  ///< since the last light
    int last_vat_ = -1;
};

}  // namespace pliant::twin
