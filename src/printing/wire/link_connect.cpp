// How host and controller agree on the number of the last line, with every release of Marlin.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "printing/wire/line_frame.hpp"
#include "printing/wire/link.hpp"

namespace pliant::host {

Status Link::wait_for_boot() {
    const double boot_end = clock_.now() + options_.boot_s;
    while (!started_ && !no_start_ && clock_.now() < boot_end) {
        if (const auto heard = hear(boot_end - clock_.now()); !heard) return tl::unexpected(heard.error());
    }
    return {};
}

/// Returns when it has answered, or after a silence that means that the line or its answer was lost. A busy controller
/// answers when it has room for the line; one that only sends other lines cannot be used for printing.
Status Link::wait_for_answer(double begin_s, const std::function<bool()>& answered) {
    double end = clock_.now() + options_.boot_s;
    while (!answered() && clock_.now() < end) {
        if (clock_.now() > std::max(begin_s, busy_s_) + options_.talk_s)
            return failure("the printer talks but does not answer; is this its port and its baud rate?");
        if (clock_.now() > begin_s + options_.busy_s)
            return failure(
                "the printer has been busy for {:.0f} s and does not answer; wait until it stands still, or reset it",
                options_.busy_s);
        const auto heard = hear(end - clock_.now());
        if (!heard) return tl::unexpected(heard.error());
        if (*heard) end = clock_.now() + options_.boot_s;
    }
    return {};
}

Status Link::no_answer() const {
    if (options_.may_be_halted)
        return failure(
            "the printer does not answer: it was halted, and has not been reset since; press the board's "
            "reset button, or switch its power off and on");
    return failure(
        "the printer does not answer; is this its port and its baud rate? A board that was halted (emergency "
        "stop, failed homing) answers only after a reset");
}

/// Every release refuses a number far ahead, whatever the last one was, and the refusal contains the last one. The
/// checksum is wrong, so that the line is not accepted even if its number happens to be the next.
Status Link::put_probe() {
    return put("\nN2147483640 M400*0\n");
}

/// The last line that the controller has accepted. nullopt: it did not say.
Result<std::optional<long>> Link::probe_last_line(double begin_s) {
    wanted_.reset();
    if (Status status = put_probe(); !status) return tl::unexpected(status.error());
    if (Status status = wait_for_answer(begin_s, [this] { return wanted_.has_value(); }); !status)
        return tl::unexpected(status.error());
    if (Status status = wait_until_quiet(); !status) return tl::unexpected(status.error());
    ignore_ok_ = false;
    const auto wanted = std::exchange(wanted_, std::nullopt);
    if (!wanted || *wanted < 1) return std::nullopt;
    return *wanted - 1;
}

/// Bytes get lost in this direction, too: a number counts once it was received twice.
Result<long> Link::last_line() {
    if (Status status = wait_for_boot(); !status) return tl::unexpected(status.error());
    const double begin_s = clock_.now();
    std::optional<long> before;
    int silences = 0;
    for (int attempt = 0; attempt < 2 * options_.most_connects && silences < options_.most_connects; ++attempt) {
        if (Status status = wait_until_quiet(); !status) return tl::unexpected(status.error());
        const auto last = probe_last_line(begin_s);
        if (!last) return tl::unexpected(last.error());
        silences = *last ? 0 : silences + 1;
        if (*last && *last == before) return **last;
        before = *last;
    }
    return tl::unexpected(no_answer().error());
}

/// M110 acts when it is received, and again when it is executed; and an `ok` may belong to a line of another host. So
/// the proof is an echo sent after it, and then the number that the controller reports.
Result<bool> Link::set_base(long base, int attempt, double begin_s) {
    wanted_.reset();
    fence_seen_ = false;
    awaited_ = fmt::format("echo:base {} {}", base, attempt);
    outstanding_.push_back({base, 0});
    if (Status status = put(framed_line(base, fmt::format("M110 N{}", base))); !status)
        return tl::unexpected(status.error());
    if (Status status = wait_for_answer(begin_s, [this] { return outstanding_.empty() || wanted_.has_value(); });
        !status)
        return tl::unexpected(status.error());
    if (!outstanding_.empty() || wanted_) return false;  // lost, or damaged
    if (Status status = put(fmt::format("\nM118 E1 base {} {}\n", base, attempt)); !status)
        return tl::unexpected(status.error());
    if (Status status = wait_for_answer(begin_s, [this] { return fence_seen_ || wanted_.has_value(); }); !status)
        return tl::unexpected(status.error());
    if (!fence_seen_) return false;
    if (Status status = wait_until_quiet(); !status) return tl::unexpected(status.error());
    const auto last = probe_last_line(begin_s);
    if (!last) return tl::unexpected(last.error());
    return *last == base;
}

Status Link::connect(long base) {
    if (Status status = wait_for_boot(); !status) return status;
    base_ = base;
    next_number_ = next_to_send_ = base + 1;
    const double begin_s = clock_.now();
    for (int attempt = 0; attempt < options_.most_connects; ++attempt) {
        if (Status status = wait_until_quiet(); !status) return status;
        drop_outstanding([](long) { return true; });
        const auto is_set = set_base(base, attempt, begin_s);
        if (!is_set) return tl::unexpected(is_set.error());
        ignore_ok_ = false;
        wanted_.reset();
        connected_ = *is_set;
        if (connected_) return {};
    }
    return no_answer();
}

}  // namespace pliant::host
