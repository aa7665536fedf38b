// A reliable stream of commands to Marlin over a wire that loses and damages bytes.
//
// Lines are numbered and have checksums; as many are in flight as the firmware's queue and receive buffer hold. After a
// refused line the link waits until the wire is quiet and resends from that line; for this it keeps every line since
// connect(). Every command must be safe to execute twice (absolute coordinates), because the protocol cannot exclude
// that. Completion is confirmed by fences: `M400` and `M118 E1 tok N`, an echo that returns only when all motion is
// done.
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
    int window_lines = 4;          ///< fewer if the firmware reports (ADVANCED_OK) fewer free places
    int window_bytes = 120;        ///< less than the receive buffer
    double boot_s = 3;             ///< maximum time until `start` after the port was opened
    double answer_timeout_s = 12;  ///< silence after which an answer counts as lost; `busy` comes every 2 s
    double quiet_s = 0.2;          ///< silence after which nothing more is in flight
    int most_repeats = 10;         ///< of the same line, and of consecutive silences
    /// Maximum fraction of recent lines that may need repeating. Above it the wire is no longer trusted: if a fraction
    /// r of the lines arrives damaged, an 8-bit checksum lets about r^2 / 14 of all lines through damaged.
    double most_refused = 0.2;
    double talk_s = 60;           ///< maximum time that a controller which is not busy may send other lines before it
                                  ///< answers connect()
    double busy_s = 300;          ///< maximum time that connect() waits for a controller that reports `busy`
    int most_connects = 10;       ///< consecutive silences before connect() gives up
    double watch_every_s = 0.02;  ///< longest interval between calls of the watch while waiting
    bool may_be_halted = false;   ///< the last session ended with an emergency stop or a halt, which explains silence
};

/// The answer to M115.
struct Firmware {
    std::string name;
    std::map<std::string, bool> capabilities;  ///< "EMERGENCY_PARSER", ...

    [[nodiscard]] bool can(const std::string& capability) const;
};

/// Delay from M410, which stops motion within a millisecond, to M112. M112 alone lets a move continue for most of a
/// second; sent together with M410 it would be executed first.
inline constexpr double m112_after_m410_s = 0.01;

/// Fails at the first sign that the machine is not in the expected state: a restart, an unknown command, an error that
/// is not about a damaged line. Wire and clock must outlive it.
class Link {
public:
    Link(Wire& wire, Clock& clock, LinkOptions options = {});

    /// Called at least every LinkOptions::watch_every_s while waiting; an error ends the wait and is returned.
    void set_watch(std::function<Status()> watch) { watch_ = std::move(watch); }
    /// Receives every line other than `ok`: prompts, reports, echoes.
    void set_listener(std::function<void(std::string_view)> listener) { listener_ = std::move(listener); }

    /// Waits for the firmware to start (or finds it running) and sets the number of the last line to `base`: the next
    /// one is `base` + 1.
    [[nodiscard]] Status connect(long base = 0);
    /// Before connect(): the number of the last line that the controller accepted; 0 if it has just started. Every
    /// release of Marlin reports it when a line with a number far ahead arrives, and ignores that line. A controller
    /// that still knows the numbers of an earlier host has not been reset since.
    [[nodiscard]] Result<long> last_line();
    /// Identifies the firmware (M115). What a build does not report stays unknown.
    [[nodiscard]] Result<Firmware> introduce();

    /// Returns when the line has been sent; blocks while the window is full. No line end, no comment, at most 80
    /// characters.
    [[nodiscard]] Status send(std::string_view command);
    /// The same for a command that the firmware may not know.
    [[nodiscard]] Status send_if_known(std::string_view command);
    /// Sends a query and returns the lines received until it has been executed; the machine is then at rest.
    [[nodiscard]] Result<std::vector<std::string>> ask(std::string_view command);
    /// Returns when everything sent has been executed and all motion is done. Errors include a timeout after
    /// `within_s`.
    [[nodiscard]] Status fence(double within_s = std::numeric_limits<double>::infinity());
    /// Listens for this time and calls the watch. Without `repair`, resend requests are postponed, so that nothing
    /// delays the end.
    [[nodiscard]] Status listen_for(double seconds, bool repair = true);
    /// Whether every line has been acknowledged, so that the next one is sent at once.
    [[nodiscard]] bool is_quiet() const { return outstanding_.empty() && !wanted_ && next_to_send_ == next_number_; }

    /// Bypasses the window and has no line number: M112, M410, M108. Thread-safe if the wire is.
    void urgent(std::string_view command);
    /// M410 and M112, bypassing the window: all motion stops, and the controller must be reset.
    void halt();
    /// Stops motion at once (M410, bypassing the window) and then sends `commands` unnumbered. The link cannot be used
    /// afterwards.
    void stop(const std::deque<std::string>& commands);

    [[nodiscard]] long lines_sent() const { return next_number_ - base_ - 1; }
    /// The number of the next command.
    [[nodiscard]] long next_number() const { return next_number_; }
    [[nodiscard]] long resends() const { return resends_; }
    [[nodiscard]] bool connected() const { return connected_; }
    /// Whether the controller restarted: it has lost its position, and nothing may be sent to it.
    [[nodiscard]] bool was_reset() const { return was_reset_; }
    /// Whether `start` was received while connecting.
    [[nodiscard]] bool has_started() const { return started_; }
    /// Before connect(): the controller has already been heard on this wire, so there is no `start` to wait for.
    void expect_no_start() { no_start_ = true; }
    /// Whether the controller has halted itself, and will not answer before a reset.
    [[nodiscard]] bool has_halted() const { return halted_; }
    /// Whether it reported that homing failed: the switch was not found.
    [[nodiscard]] bool homing_failed() const { return homing_failed_; }
    /// Whether fence() ended by timeout.
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
    std::string heard_;                 ///< an incomplete line
    std::vector<std::string> history_;  ///< every line since connect(); the first one has number base_ + 1
    std::deque<Sent> outstanding_;      ///< lines sent but not acknowledged
    std::size_t outstanding_bytes_ = 0;
    int window_lines_ = 4;
    long base_ = 0;
    long next_number_ = 1;        ///< of the next command
    long next_to_send_ = 1;       ///< below next_number_ while lines wait or are resent
    std::optional<long> wanted_;  ///< line requested by the firmware
    bool ignore_ok_ = false;      ///< for the `ok` that follows a Resend
    long repeated_ = 0;           ///< last requested line, and the number of requests
    int repeats_ = 0;
    double refused_ = 0;     ///< fraction of recent lines that had to be resent
    int silences_ = 0;       ///< since the last ok
    bool probing_ = false;   ///< after a silence the firmware was asked for its last line
    bool silent_ = false;    ///< nothing is outstanding and nothing was received
    bool tolerant_ = false;  ///< unknown commands are not errors
    bool connected_ = false;
    bool started_ = false;
    bool was_reset_ = false;
    bool no_start_ = false;
    bool wire_failed_ = false;
    bool halted_ = false;
    bool homing_failed_ = false;
    bool ran_late_ = false;
    double deadline_s_ = std::numeric_limits<double>::infinity();  ///< of the current wait
    double last_write_s_ = 0;
    double busy_s_ = 0;    ///< when it last reported `busy`
    double answer_s_ = 0;  ///< when it last answered a line or reported `busy`; other lines do not count
    long resends_ = 0;
    long token_ = 0;
    std::string awaited_;  ///< the expected echo of the fence
    bool fence_seen_ = false;
    Firmware firmware_;
    std::vector<std::string>* answers_ = nullptr;  ///< to the current query
};

}  // namespace pliant::host
