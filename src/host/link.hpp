// A reliable stream of commands to a Marlin over a wire that loses and damages bytes.
//
// Lines are numbered and checksummed; up to four of them are under way at a time, and fewer bytes than the firmware's
// receive buffer. A refused line makes the link wait until the wire is quiet and go back to it. Every command must
// be safe to run twice (absolute coordinates), because the protocol cannot exclude that. What went through is known by
// fences: `M400` and `M118 E1 tok N`, an echo that comes back only when all motion is done.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "host/devices.hpp"

namespace pliant::host {

struct LinkOptions {
    int window_lines = 4;
    int window_bytes = 120;
    double boot_s = 3;             ///< how long `start` may take after the port was opened
    double answer_timeout_s = 12;  ///< silence after which an answer counts as lost; `busy` comes every 2 s
    double quiet_s = 0.2;          ///< silence after which nothing more is under way
    int most_repeats = 10;         ///< of one and the same line, and of silences in a row
};

/// Stops at the first sign that the machine is not where the stream thinks it is: a restart, an unknown command, an
/// error that is not about a damaged line. Wire and clock must outlive it.
class Link {
public:
    Link(Wire& wire, Clock& clock, LinkOptions options = {});

    /// Waits for the firmware to start (or finds it running) and sets the line number.
    [[nodiscard]] Status connect();
    /// Returns when the line is under way; blocks while the window is full. No line end, no comment, at most 80
    /// characters.
    [[nodiscard]] Status send(std::string_view command);
    /// Returns when everything sent has been executed and all motion is done.
    [[nodiscard]] Status fence();
    /// Stops motion at once (M410, past the window) and then sends `commands` unnumbered. The link is of no use after.
    void stop(const std::deque<std::string>& commands);

    [[nodiscard]] long lines_sent() const { return next_number_ - 1; }
    [[nodiscard]] long resends() const { return resends_; }
    /// Whether the controller restarted: it knows no position, nothing may be sent to it.
    [[nodiscard]] bool was_reset() const { return was_reset_; }

private:
    struct Line {
        long number = 0;
        std::string bytes;
    };

    [[nodiscard]] Status run_until(const std::function<bool()>& done);
    [[nodiscard]] Status transmit();
    [[nodiscard]] Status listen();
    [[nodiscard]] Result<bool> hear(double timeout_s);
    [[nodiscard]] Status handle(std::string_view line);
    [[nodiscard]] Status handle_error(std::string_view line);
    void handle_ok(std::string_view line);
    [[nodiscard]] Status resynchronise();
    [[nodiscard]] Status go_back_to(long number);
    [[nodiscard]] Status give_up_waiting();
    [[nodiscard]] bool window_takes(const Line& line) const;
    [[nodiscard]] const Line& line_to_send() const;
    void forget_old_lines();

    Wire& wire_;
    Clock& clock_;
    const LinkOptions options_;
    std::string heard_;             ///< a line that is not complete yet
    std::deque<Line> history_;      ///< the last lines, in order of their numbers
    std::deque<long> outstanding_;  ///< numbers that were sent and have had no ok
    long next_number_ = 1;          ///< of the next command
    long next_to_send_ = 1;         ///< below next_number_ while lines wait or are repeated
    std::optional<long> wanted_;    ///< line that the firmware asks for
    bool ignore_ok_ = false;        ///< the one that follows a Resend
    long repeated_ = 0;             ///< line that was asked for last, and how often
    int repeats_ = 0;
    int silences_ = 0;      ///< since the last ok
    bool probing_ = false;  ///< a line was repeated after a silence, to find out where the firmware is
    bool silent_ = false;   ///< nothing is outstanding and nothing came
    bool connected_ = false;
    bool started_ = false;
    bool was_reset_ = false;
    long resends_ = 0;
    long token_ = 0;
    std::string awaited_;  ///< the echo of the fence
    bool fence_seen_ = false;
};

}  // namespace pliant::host
