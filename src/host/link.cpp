#include "host/link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace pliant::host {
namespace {

constexpr std::size_t longest_command = 80;  // leaves room for N, number and checksum in Marlin's 95
constexpr std::size_t history_lines = 256;
constexpr std::size_t longest_answer = 4096;

bool begins(std::string_view text, std::string_view with) {
    return text.substr(0, with.size()) == with;
}

bool contains(std::string_view text, std::string_view part) {
    return text.find(part) != std::string_view::npos;
}

std::string_view trim(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\r')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.remove_suffix(1);
    return text;
}

/// A number that is the whole text. Bytes get lost on the way here too: half a number is none.
std::optional<long> whole_number(std::string_view text) {
    text = trim(text);
    long value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || end != text.data() + text.size() || value < 0) return std::nullopt;
    return value;
}

std::string framed(long number, std::string_view command) {
    std::string line = fmt::format("N{} {}", number, command);
    int sum = 0;
    for (const char c : line) sum ^= static_cast<unsigned char>(c);
    return fmt::format("{}*{}\n", line, sum);
}

bool is_restart(std::string_view line) {
    constexpr std::array<std::string_view, 5> causes = {"PowerUp", "External Reset", "Brown out Reset",
                                                        "Watchdog Reset", "Software Reset"};
    if (line == "start") return true;
    if (begins(line, "echo:")) line = trim(line.substr(5));
    return std::find(causes.begin(), causes.end(), line) != causes.end();
}

}  // namespace

Link::Link(Wire& wire, Clock& clock, LinkOptions options) : wire_(wire), clock_(clock), options_(options) {}

// --- what the caller asks for --------------------------------------------------------------------------------------

Status Link::connect() {
    const double boot_end = clock_.now() + options_.boot_s;
    while (!started_ && clock_.now() < boot_end) {
        if (const auto heard = hear(boot_end - clock_.now()); !heard) return tl::unexpected(heard.error());
    }
    for (int attempt = 0; attempt < options_.most_repeats; ++attempt) {
        for (bool more = true; more;) {
            const auto heard = hear(options_.quiet_s);
            if (!heard) return tl::unexpected(heard.error());
            more = *heard;
        }
        outstanding_.assign(1, 0);
        ignore_ok_ = false;
        wanted_.reset();
        if (Status status = wire_.write(framed(0, "M110 N0")); !status) return status;
        const double end = clock_.now() + options_.boot_s;
        while (!outstanding_.empty() && !wanted_ && clock_.now() < end) {
            if (const auto heard = hear(end - clock_.now()); !heard) return tl::unexpected(heard.error());
        }
        connected_ = outstanding_.empty() && !wanted_;
        if (connected_) return {};
    }
    return failure("the printer does not answer; is this its port and its baud rate?");
}

Status Link::send(std::string_view command) {
    if (command.empty() || command.size() > longest_command || contains(command, "\n") || contains(command, ";")) {
        return input_error("\"{}\" cannot be sent: a command has 1 to {} characters and no comment", command,
                           longest_command);
    }
    history_.push_back({next_number_, framed(next_number_, command)});
    ++next_number_;
    return run_until([this] { return next_to_send_ == next_number_; });
}

Status Link::fence() {
    for (int attempt = 0; attempt < options_.most_repeats; ++attempt) {
        awaited_ = fmt::format("echo:tok {}", ++token_);
        fence_seen_ = false;
        silent_ = false;
        if (Status status = send("M400"); !status) return status;
        if (Status status = send(fmt::format("M118 E1 tok {}", token_)); !status) return status;
        if (Status status = run_until([this] { return fence_seen_ || silent_; }); !status) return status;
        if (!fence_seen_) continue;
        // Everything before the token has been executed, whatever became of its ok.
        while (outstanding_.size() > 1) outstanding_.pop_front();
        return {};
    }
    return failure("the printer answers, but never the echo that ends a move");
}

void Link::stop(const std::deque<std::string>& commands) {
    // Errors do not matter any more: everything possible is tried.
    connected_ = false;
    (void)wire_.write("\nM410\n");
    for (int i = 0; i < 50; ++i) {
        const auto heard = hear(options_.quiet_s);
        if (!heard || !*heard) break;
    }
    for (const std::string& command : commands) (void)wire_.write(command + "\n");
}

// --- sending -------------------------------------------------------------------------------------------------------

const Link::Line& Link::line_to_send() const {
    return history_[static_cast<std::size_t>(next_to_send_ - history_.front().number)];
}

bool Link::window_takes(const Line& line) const {
    if (outstanding_.empty()) return true;
    if (static_cast<int>(outstanding_.size()) >= options_.window_lines) return false;
    std::size_t bytes = line.bytes.size();
    for (const Line& old : history_) {
        if (std::find(outstanding_.begin(), outstanding_.end(), old.number) != outstanding_.end()) {
            bytes += old.bytes.size();
        }
    }
    return bytes <= static_cast<std::size_t>(options_.window_bytes);
}

Status Link::transmit() {
    while (next_to_send_ < next_number_ && window_takes(line_to_send())) {
        if (Status status = wire_.write(line_to_send().bytes); !status) return status;
        outstanding_.push_back(next_to_send_);
        ++next_to_send_;
    }
    forget_old_lines();
    return {};
}

void Link::forget_old_lines() {
    while (history_.size() > history_lines && history_.front().number < next_to_send_) history_.pop_front();
}

Status Link::run_until(const std::function<bool()>& done) {
    for (;;) {
        if (Status status = transmit(); !status) return status;
        if (done()) return {};
        if (Status status = listen(); !status) return status;
    }
}

// --- listening -----------------------------------------------------------------------------------------------------

/// Handles the next answers; a long silence means that one was lost.
Status Link::listen() {
    const auto heard = hear(options_.answer_timeout_s);
    if (!heard) return tl::unexpected(heard.error());
    if (!*heard) return give_up_waiting();
    return wanted_ ? resynchronise() : Status{};
}

/// Reads once and handles every complete line; false if nothing came in time.
Result<bool> Link::hear(double timeout_s) {
    const auto bytes = wire_.read(timeout_s);
    if (!bytes) return tl::unexpected(bytes.error());
    if (bytes->empty()) return false;
    heard_ += *bytes;
    for (std::size_t end = heard_.find('\n'); end != std::string::npos; end = heard_.find('\n')) {
        const std::string line = heard_.substr(0, end);
        heard_.erase(0, end + 1);
        if (Status status = handle(trim(line)); !status) return tl::unexpected(status.error());
    }
    if (heard_.size() > longest_answer) heard_.clear();
    return true;
}

Status Link::handle(std::string_view line) {
    if (is_restart(line)) {
        started_ = true;
        if (!connected_) return {};
        was_reset_ = true;
        return failure("the printer restarted in the middle of the print: its position is lost");
    }
    if (line == "ok" || begins(line, "ok ")) {
        handle_ok(line);
    } else if (begins(line, "Resend:")) {
        if (const auto number = whole_number(line.substr(7))) wanted_ = *number;
        ignore_ok_ = true;
    } else if (begins(line, "Error:")) {
        return handle_error(line);
    } else if (connected_ && begins(line, "echo:Unknown command:")) {
        return failure("the printer does not know a command of the job: {}", trim(line.substr(21)));
    } else if (!awaited_.empty() && line == awaited_) {
        fence_seen_ = true;
    }
    return {};
}

/// A damaged line is asked for again; anything else that the firmware calls an error ends the print.
Status Link::handle_error(std::string_view line) {
    const bool damaged = contains(line, "Line Number is not Last") || contains(line, "checksum mismatch") ||
                         contains(line, "No Checksum with line number");
    if (!damaged) return connected_ ? failure("the printer reports: {}", trim(line.substr(6))) : Status{};
    // The Resend that should follow may be lost: the error itself says as much.
    const std::size_t last = line.find("Last Line:");
    if (last != std::string_view::npos) {
        if (const auto number = whole_number(line.substr(last + 10))) wanted_ = *number + 1;
    }
    return {};
}

void Link::handle_ok(std::string_view line) {
    if (std::exchange(ignore_ok_, false)) return;
    silences_ = 0;
    probing_ = false;
    if (begins(line, "ok N")) {
        const std::string_view rest = line.substr(4);
        if (const auto number = whole_number(rest.substr(0, rest.find(' ')))) {
            while (!outstanding_.empty() && outstanding_.front() <= *number) outstanding_.pop_front();
            return;
        }
    }
    if (!outstanding_.empty()) outstanding_.pop_front();
}

// --- recovering ----------------------------------------------------------------------------------------------------

/// Lines in flight behind a bad one are refused one by one; only when the wire is quiet is the state known.
Status Link::resynchronise() {
    const double end = clock_.now() + options_.answer_timeout_s;
    while (clock_.now() < end) {
        const auto heard = hear(options_.quiet_s);
        if (!heard) return tl::unexpected(heard.error());
        if (!*heard) break;
    }
    ignore_ok_ = false;
    const long number = *std::exchange(wanted_, std::nullopt);
    return go_back_to(number);
}

Status Link::go_back_to(long number) {
    const long oldest = history_.empty() ? next_number_ : history_.front().number;
    if (number > next_number_ || number < oldest) {
        return failure("the printer asks for line {}, lines {} to {} are at hand", number, oldest, next_number_ - 1);
    }
    repeats_ = number == repeated_ ? repeats_ + 1 : 0;
    repeated_ = number;
    if (repeats_ > options_.most_repeats) {
        return failure("line {} was refused {} times: the wire is too noisy", number, repeats_);
    }
    resends_ += next_to_send_ > number ? next_to_send_ - number : 0;
    next_to_send_ = number;
    // Lines before it have arrived and owe their ok still, unless a long silence has told that their oks are lost.
    const bool lost = std::exchange(probing_, false);
    std::erase_if(outstanding_, [&](long n) { return lost || n >= number; });
    return {};
}

/// Asks by repeating the oldest line that has had no ok: if it was executed, the firmware asks for the next one.
Status Link::give_up_waiting() {
    if (++silences_ > options_.most_repeats) return failure("the printer has stopped answering");
    if (outstanding_.empty()) {
        silent_ = true;
        return {};
    }
    const long oldest = outstanding_.front();
    outstanding_.clear();
    if (Status status = go_back_to(oldest); !status) return status;
    probing_ = true;
    return {};
}

}  // namespace pliant::host
