// A reliable stream of commands to a Marlin over a wire that loses and damages bytes.
//
// Lines are numbered and checksummed; as many of them are under way as the firmware's queue and receive buffer hold. A
// refused line makes the link wait until the wire is quiet and go back to it; every line since connect() is kept for
// that. Every command must be safe to run twice (absolute coordinates), because the protocol cannot exclude that. What
// went through is known by fences: `M400` and `M118 E1 tok N`, an echo that comes back only when all motion is done.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/wire/devices.hpp"

namespace pliant::host {

struct LinkOptions {
    int window_lines = 4;          ///< fewer if the firmware says (ADVANCED_OK) that it has fewer places
    int window_bytes = 120;        ///< below the receive buffer
    double boot_s = 3;             ///< how long `start` may take after the port was opened
    double answer_timeout_s = 12;  ///< silence after which an answer counts as lost; `busy` comes every 2 s
    double quiet_s = 0.2;          ///< silence after which nothing more is under way
    int most_repeats = 10;         ///< of one and the same line, and of silences in a row
    /// Share of recent lines that may come to be repeated. Beyond it the wire is not trusted any more: a checksum of 8
    /// bits lets about r^2 / 14 of all lines through damaged where r of them arrive damaged.
    double most_refused = 0.2;
    double talk_s = 60;           ///< how long one that is not busy may say other things before it answers connect()
    int most_connects = 10;       ///< silences in a row before connect() gives up
    double watch_every_s = 0.02;  ///< how often the watch is asked, at least, while something is waited for
    bool may_be_halted = false;   ///< an emergency stop or a halt came last: what a silence means then
};

/// What M115 says.
struct Firmware {
    std::string name;
    std::map<std::string, bool> capabilities;  ///< "EMERGENCY_PARSER", ...

    [[nodiscard]] bool can(const std::string& capability) const;
};

/// How long after M410, which stops motion within a millisecond, M112 follows. M112 alone lets a move go on for most of
/// a second; at the same time as M410 it would be heeded first.
inline constexpr double m112_after_m410_s = 0.01;

/// Stops at the first sign that the machine is not where the stream thinks it is: a restart, an unknown command, an
/// error that is not about a damaged line. Wire and clock must outlive it.
class Link {
public:
    Link(Wire& wire, Clock& clock, LinkOptions options = {});

    /// Asked at least every LinkOptions::watch_every_s while something is waited for; an error ends the waiting and is
    /// what the call returns.
    void set_watch(std::function<Status()> watch) { watch_ = std::move(watch); }
    /// Gets every line that is heard and is no `ok`: prompts, reports, echoes.
    void set_listener(std::function<void(std::string_view)> listener) { listener_ = std::move(listener); }

    /// Waits for the firmware to start (or finds it running) and makes `base` the number of the last line: the next one
    /// is `base` + 1.
    [[nodiscard]] Status connect(long base = 0);
    /// Before connect(): the number of the last line that the controller has taken; 0 if it has just started. Every
    /// release of Marlin names it when a line with a number far ahead arrives, and takes nothing of that line. A
    /// controller that still knows the numbers of an earlier host has not been reset since.
    [[nodiscard]] Result<long> last_line();
    /// Asks who it is (M115). What a build does not say stays unknown.
    [[nodiscard]] Result<Firmware> introduce();

    /// Returns when the line is under way; blocks while the window is full. No line end, no comment, at most 80
    /// characters.
    [[nodiscard]] Status send(std::string_view command);
    /// The same for a command that the firmware need not know.
    [[nodiscard]] Status send_if_known(std::string_view command);
    /// Sends a query and returns the lines that come back until it has been carried out; the machine stands still then.
    [[nodiscard]] Result<std::vector<std::string>> ask(std::string_view command);
    /// Returns when everything sent has been executed and all motion is done. Errors: not within so long, too.
    [[nodiscard]] Status fence(double within_s = std::numeric_limits<double>::infinity());
    /// Listens for so long, and lets the watch be asked. Without `repair` what the firmware asks for again is left for
    /// later: nothing delays the end.
    [[nodiscard]] Status listen_for(double seconds, bool repair = true);
    /// Whether every line has had its ok: the next one goes out at once.
    [[nodiscard]] bool is_quiet() const { return outstanding_.empty() && !wanted_ && next_to_send_ == next_number_; }

    /// Past the window and without a number: M112, M410, M108. May be called from any thread if the wire allows it.
    void urgent(std::string_view command);
    /// M410 and M112, past the window: nothing moves any more, and the controller must be reset.
    void halt();
    /// Stops motion at once (M410, past the window) and then sends `commands` unnumbered. The link is of no use after.
    void stop(const std::deque<std::string>& commands);

    [[nodiscard]] long lines_sent() const { return next_number_ - base_ - 1; }
    /// The number that the next command will carry.
    [[nodiscard]] long next_number() const { return next_number_; }
    [[nodiscard]] long resends() const { return resends_; }
    [[nodiscard]] bool connected() const { return connected_; }
    /// Whether the controller restarted: it knows no position, nothing may be sent to it.
    [[nodiscard]] bool was_reset() const { return was_reset_; }
    /// Whether `start` was heard while connecting.
    [[nodiscard]] bool has_started() const { return started_; }
    /// Before connect(): the controller has been heard before on this wire, there is no `start` to wait for.
    void expect_no_start() { no_start_ = true; }
    /// Whether the controller has halted itself, and answers nothing before it is reset.
    [[nodiscard]] bool has_halted() const { return halted_; }
    /// Whether it has said that homing failed: the switch was not found.
    [[nodiscard]] bool homing_failed() const { return homing_failed_; }
    /// Whether fence() ended because its time was over.
    [[nodiscard]] bool ran_late() const { return ran_late_; }
    /// Whether the wire itself broke.
    [[nodiscard]] bool wire_failed() const { return wire_failed_; }

private:
    struct Sent {
        long number = 0;
        std::size_t bytes = 0;
    };

    [[nodiscard]] Status pass_fence();
    [[nodiscard]] Status run_until(const std::function<bool()>& done);
    [[nodiscard]] Status transmit();
    [[nodiscard]] Status listen();
    [[nodiscard]] Result<bool> hear(double timeout_s);
    [[nodiscard]] Result<bool> hear_once(double timeout_s);
    [[nodiscard]] Status wait_for_boot();
    [[nodiscard]] Status put_probe();
    [[nodiscard]] Result<std::optional<long>> probe_last_line(double begin_s);
    [[nodiscard]] Result<bool> set_base(long base, int attempt, double begin_s);
    [[nodiscard]] Status no_answer() const;
    [[nodiscard]] Status put(std::string_view bytes);
    [[nodiscard]] Status wait_until_quiet();
    [[nodiscard]] Status wait_for_answer(double begin_s, const std::function<bool()>& answered);
    [[nodiscard]] Status handle(std::string_view line);
    [[nodiscard]] Status handle_error(std::string_view line);
    [[nodiscard]] Status handle_halt(std::string_view error);
    [[nodiscard]] Status handle_unknown(std::string_view line);
    [[nodiscard]] Status handle_restart();
    void handle_ok(std::string_view line);
    void handle_wait();
    void handle_firmware(std::string_view line);
    void adapt_window(std::string_view answer);
    [[nodiscard]] Status resynchronise();
    [[nodiscard]] Status note_refusal();
    [[nodiscard]] Status go_back_to(long number);
    [[nodiscard]] Status give_up_waiting();
    [[nodiscard]] bool window_takes(const std::string& line) const;
    [[nodiscard]] const std::string& line_bytes(long number) const;
    [[nodiscard]] bool has_been_sent(std::string_view command) const;
    void drop_outstanding(const std::function<bool(long number)>& which);

    Wire& wire_;
    Clock& clock_;
    const LinkOptions options_;
    std::function<Status()> watch_;
    std::function<void(std::string_view)> listener_;
    std::string heard_;                 ///< a line that is not complete yet
    std::vector<std::string> history_;  ///< every line since connect(), the first one has number base_ + 1
    std::deque<Sent> outstanding_;      ///< lines that were sent and have had no ok
    std::size_t outstanding_bytes_ = 0;
    int window_lines_ = 4;
    long base_ = 0;
    long next_number_ = 1;        ///< of the next command
    long next_to_send_ = 1;       ///< below next_number_ while lines wait or are repeated
    std::optional<long> wanted_;  ///< line that the firmware asks for
    bool ignore_ok_ = false;      ///< the one that follows a Resend
    long repeated_ = 0;           ///< line that was asked for last, and how often
    int repeats_ = 0;
    double refused_ = 0;     ///< share of recent lines that had to be repeated
    int silences_ = 0;       ///< since the last ok
    bool probing_ = false;   ///< after a silence the firmware was asked for its last line
    bool silent_ = false;    ///< nothing is outstanding and nothing came
    bool tolerant_ = false;  ///< unknown commands are no error
    bool connected_ = false;
    bool started_ = false;
    bool was_reset_ = false;
    bool no_start_ = false;
    bool wire_failed_ = false;
    bool halted_ = false;
    bool homing_failed_ = false;
    bool ran_late_ = false;
    double deadline_s_ = std::numeric_limits<double>::infinity();  ///< of what is waited for
    double last_write_s_ = 0;
    double busy_s_ = 0;    ///< when it last said that it is
    double answer_s_ = 0;  ///< when it last answered a line or was busy; other talk is no answer
    long resends_ = 0;
    long token_ = 0;
    std::string awaited_;  ///< the echo of the fence
    bool fence_seen_ = false;
    Firmware firmware_;
    std::vector<std::string>* answers_ = nullptr;  ///< of the query under way
};

}  // namespace pliant::host
