#include "printing/wire/link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/core/letters.hpp"
#include "base/core/parse_all.hpp"
#include "printing/wire/line_frame.hpp"

namespace pliant::host {
namespace {

constexpr std::size_t longest_command = 80;  // leaves room for N, number and checksum in Marlin's 95
constexpr double late_s = 0.02;              // tolerance of a fence's deadline
constexpr double echo_timeout_s = 4;         // for the echo of a fence; `busy` comes every 2 s before it
constexpr std::size_t longest_answer = 4096;
constexpr double recent_lines = 200;      // number of lines by which the wire is judged
constexpr long most_number = 2147483647;  // firmware uses 32-bit line numbers

bool begins(std::string_view text, std::string_view with) {
    return text.substr(0, with.size()) == with;
}

bool contains(std::string_view text, std::string_view part) {
    return text.find(part) != std::string_view::npos;
}

/// A valid line number that is the whole text. Bytes get lost in this direction, too: a truncated number does not
/// count.
std::optional<long> whole_number(std::string_view text) {
    long value = 0;
    const bool whole = parse_all(trimmed(text), value);
    return whole && value >= 0 && value <= most_number ? std::optional(value) : std::nullopt;
}

bool is_restart(std::string_view line) {
    constexpr std::array<std::string_view, 5> causes = {"PowerUp", "External Reset", "Brown out Reset",
                                                        "Watchdog Reset", "Software Reset"};
    if (line == "start") return true;
    if (begins(line, "echo:")) line = trimmed(line.substr(5));
    return std::find(causes.begin(), causes.end(), line) != causes.end();
}

}  // namespace

bool Firmware::can(const std::string& capability) const {
    const auto found = capabilities.find(capability);
    return found != capabilities.end() && found->second;
}

Link::Link(Wire& wire, Clock& clock, LinkOptions options)
    : wire_(wire), clock_(clock), options_(options), window_lines_(options.window_lines) {}

// Public functions.

Status Link::put(std::string_view bytes) {
    Status status = wire_.write(bytes);
    wire_failed_ = wire_failed_ || !status;
    return status;
}

Status Link::wait_until_quiet() {
    const double end = clock_.now() + options_.answer_timeout_s;
    while (clock_.now() < end) {
        const auto heard = hear(options_.quiet_s);
        if (!heard) return tl::unexpected(heard.error());
        if (!*heard) break;
    }
    return {};
}

Result<Firmware> Link::introduce() {
    firmware_ = {};
    tolerant_ = true;
    Status status = send("M115");
    if (status) status = fence();
    tolerant_ = false;
    if (!status) return tl::unexpected(status.error());
    return firmware_;
}

Status Link::send(std::string_view command) {
    if (command.empty() || command.size() > longest_command || contains(command, "\n") || contains(command, ";")) {
        return input_error("\"{}\" cannot be sent: a command has 1 to {} characters and no comment", command,
                           longest_command);
    }
    refused_ *= 1 - 1 / recent_lines;
    history_.push_back(framed_line(next_number_, command));
    ++next_number_;
    return run_until([this] { return next_to_send_ == next_number_; });
}

Status Link::send_if_known(std::string_view command) {
    tolerant_ = true;
    Status status = send(command);
    if (status) status = fence();
    tolerant_ = false;
    return status;
}

Result<std::vector<std::string>> Link::ask(std::string_view command) {
    if (Status status = fence(); !status) return tl::unexpected(status.error());
    std::vector<std::string> answers;
    answers_ = &answers;
    Status status = send(command);
    if (status) status = fence();
    answers_ = nullptr;
    if (!status) return tl::unexpected(status.error());
    return answers;
}

Status Link::fence(double within_s) {
    deadline_s_ = clock_.now() + within_s;
    Status status = pass_fence();
    deadline_s_ = std::numeric_limits<double>::infinity();
    return status;
}

Status Link::pass_fence() {
    for (int attempt = 0; attempt < options_.most_repeats; ++attempt) {
        awaited_ = fmt::format("echo:tok {}", ++token_);
        fence_seen_ = false;
        silent_ = false;
        if (Status status = send("M400"); !status) return status;
        if (Status status = send(fmt::format("M118 E1 tok {}", token_)); !status) return status;
        if (Status status = run_until([this] { return fence_seen_ || silent_; }); !status) return status;
        if (!fence_seen_) continue;
        // Everything before the token has been executed, even if its `ok` was lost.
        const long token_line = next_number_ - 1;
        drop_outstanding([&](long number) { return number < token_line; });
        return {};
    }
    return failure("the printer answers, but never sends the echo that marks the end of a move (M118)");
}

Status Link::listen_for(double seconds, bool repair) {
    const double end = clock_.now() + seconds;
    do {
        const auto heard = hear(std::max(0.0, end - clock_.now()));
        if (!heard) return tl::unexpected(heard.error());
        if (repair && wanted_ && next_number_ > base_ + 1) {
            if (Status status = resynchronise(); !status) return status;
            if (Status status = transmit(); !status) return status;
        }
    } while (clock_.now() < end);
    return {};
}

void Link::urgent(std::string_view command) {
    (void)wire_.write(fmt::format("\n{}\n", command));
}

void Link::halt() {
    urgent("M410");
    clock_.sleep(m112_after_m410_s);
    urgent("M112");
    halted_ = true;
}

void Link::stop(const std::deque<std::string>& commands) {
    // Errors are ignored from here on: everything possible is tried.
    connected_ = false;
    watch_ = nullptr;
    urgent("M410");
    for (int i = 0; i < 50; ++i) {
        const auto heard = hear(options_.quiet_s);
        if (!heard || !*heard) break;
    }
    for (const std::string& command : commands) (void)wire_.write(command + "\n");
}

// Sending.

const std::string& Link::line_bytes(long number) const {
    return history_[static_cast<std::size_t>(number - base_ - 1)];
}

bool Link::window_takes(const std::string& line) const {
    if (outstanding_.empty()) return true;
    if (static_cast<int>(outstanding_.size()) >= window_lines_) return false;
    return outstanding_bytes_ + line.size() <= static_cast<std::size_t>(options_.window_bytes);
}

Status Link::transmit() {
    while (next_to_send_ < next_number_ && window_takes(line_bytes(next_to_send_))) {
        const std::string& line = line_bytes(next_to_send_);
        if (Status status = put(line); !status) return status;
        last_write_s_ = clock_.now();
        outstanding_.push_back({next_to_send_, line.size()});
        outstanding_bytes_ += line.size();
        ++next_to_send_;
    }
    return {};
}

void Link::drop_outstanding(const std::function<bool(long number)>& which) {
    std::erase_if(outstanding_, [&](const Sent& sent) { return which(sent.number); });
    outstanding_bytes_ = 0;
    for (const Sent& sent : outstanding_) outstanding_bytes_ += sent.bytes;
}

Status Link::run_until(const std::function<bool()>& done) {
    answer_s_ = clock_.now();
    for (;;) {
        if (Status status = transmit(); !status) return status;
        if (done()) return {};
        ran_late_ = clock_.now() > deadline_s_;
        if (ran_late_) return failure("the printer is not done in time");
        if (Status status = listen(); !status) return status;
    }
}

// Receiving.

/// Handles the next answers; a long time without one means that it was lost, whatever other lines arrive.
Status Link::listen() {
    const double patience_s = outstanding_.empty() ? echo_timeout_s : options_.answer_timeout_s;
    const double left_s = std::max(0.0, deadline_s_ - clock_.now()) + late_s;
    const auto heard = hear(std::min(patience_s, left_s));
    if (left_s < patience_s && heard && !*heard) return {};
    if (!heard) return tl::unexpected(heard.error());
    if (wanted_) return resynchronise();
    const bool is_late = clock_.now() - answer_s_ > patience_s;
    return *heard && !is_late ? Status{} : give_up_waiting();
}

/// Reads once and handles every complete line; false if nothing arrived in time. Calls the watch meanwhile.
Result<bool> Link::hear(double timeout_s) {
    if (!watch_) return hear_once(timeout_s);
    const double end = clock_.now() + timeout_s;
    for (;;) {
        if (Status status = watch_(); !status) return tl::unexpected(status.error());
        const auto heard = hear_once(std::clamp(end - clock_.now(), 0.0, options_.watch_every_s));
        if (!heard || *heard) return heard;
        if (clock_.now() >= end) return false;
    }
}

Result<bool> Link::hear_once(double timeout_s) {
    const auto bytes = wire_.read(timeout_s);
    wire_failed_ = wire_failed_ || !bytes;
    if (!bytes) return tl::unexpected(bytes.error());
    if (bytes->empty()) return false;
    heard_ += *bytes;
    for (std::size_t end = heard_.find('\n'); end != std::string::npos; end = heard_.find('\n')) {
        const std::string line = heard_.substr(0, end);
        heard_.erase(0, end + 1);
        if (Status status = handle(trimmed(line)); !status) return tl::unexpected(status.error());
    }
    if (heard_.size() > longest_answer) heard_.clear();
    return true;
}

Status Link::handle(std::string_view line) {
    if (line.empty()) return {};
    const bool plain_ok = line == "ok" || begins(line, "ok ");
    if (listener_ && !plain_ok) listener_(line);
    if (is_restart(line)) return handle_restart();
    if (plain_ok) {
        handle_ok(line);
    } else if (begins(line, "Resend:")) {
        if (const auto number = whole_number(line.substr(7))) wanted_ = *number;
        ignore_ok_ = true;
        answer_s_ = clock_.now();
    } else if (begins(line, "Error:")) {
        return handle_error(line);
    } else if (begins(line, "echo:Unknown command:")) {
        return handle_unknown(line);
    } else if (begins(line, "echo:Home ") && line.ends_with(" First")) {
        return connected_ ? failure("the printer skipped a move: {}", line.substr(5)) : Status{};
    } else if (begins(line, "echo:Homing Failed")) {
        homing_failed_ = true;
    } else if (begins(line, "echo:busy:")) {
        busy_s_ = answer_s_ = clock_.now();
    } else if (line == "wait") {
        handle_wait();
    } else if (!awaited_.empty() && line == awaited_) {
        fence_seen_ = true;
    } else {
        handle_firmware(line);
        if (answers_ != nullptr && !begins(line, "echo:")) answers_->emplace_back(line);
    }
    return {};
}

Status Link::handle_restart() {
    started_ = true;
    if (!connected_) return {};
    was_reset_ = true;
    connected_ = false;
    return failure("the printer restarted in the middle of the print: its position is lost");
}

void Link::handle_firmware(std::string_view line) {
    if (begins(line, "FIRMWARE_NAME:")) {
        std::string_view name = line.substr(14);
        for (const char* key : {" SOURCE_CODE_URL:", " PROTOCOL_VERSION:"}) name = name.substr(0, name.find(key));
        firmware_.name = trimmed(name);
    }
    if (!begins(line, "Cap:")) return;
    const std::string_view rest = line.substr(4);
    const std::size_t colon = rest.find(':');
    if (colon == std::string_view::npos || rest.size() != colon + 2) return;
    firmware_.capabilities[std::string(rest.substr(0, colon))] = rest[colon + 1] == '1';
}

/// If the quoted text is one of our commands, the firmware does not support it. Otherwise noise has changed a line,
/// which will be requested again.
Status Link::handle_unknown(std::string_view line) {
    if (!connected_ || tolerant_) return {};
    const std::string_view text = trimmed(line.substr(21));
    const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    const std::string_view command = quoted ? text.substr(1, text.size() - 2) : text;
    if (!has_been_sent(command)) return {};
    return failure("the printer does not know a command of the job: {}", text);
}

/// Whether a recent line contained it; firmware may quote only the command's first word.
bool Link::has_been_sent(std::string_view command) const {
    constexpr std::size_t recent = 64;
    if (command.empty()) return false;
    const std::size_t begin = history_.size() - std::min(history_.size(), recent);
    for (std::size_t i = begin; i < history_.size(); ++i) {
        const std::string_view line = history_[i];
        std::string_view sent = line.substr(line.find(' ') + 1);
        sent = sent.substr(0, sent.rfind('*'));
        if (sent == command || sent.substr(0, sent.find(' ')) == command) return true;
    }
    return false;
}

/// A damaged line is requested again; anything else that the firmware calls an error ends the print.
Status Link::handle_error(std::string_view line) {
    const bool damaged = contains(line, "Line Number is not Last") || contains(line, "checksum mismatch") ||
                         contains(line, "No Checksum with line number");
    if (!damaged) return handle_halt(trimmed(line.substr(6)));
    // The Resend that should follow may be lost, but the error contains the same number.
    const std::size_t last = line.find("Last Line:");
    if (last != std::string_view::npos) {
        if (const auto number = whole_number(line.substr(last + 10))) wanted_ = *number + 1;
    }
    return {};
}

/// An error that is not about a line. Killed firmware does not answer any more.
Status Link::handle_halt(std::string_view error) {
    halted_ = halted_ || contains(error, "halted") || contains(error, "kill()");
    if (!connected_) return {};
    if (!halted_) return failure("the printer reports: {}", error);
    return failure("{}the printer reports: {}; reset the board before anything else",
                   homing_failed_ ? "homing failed, a limit switch was not found; " : "", error);
}

void Link::handle_ok(std::string_view line) {
    answer_s_ = clock_.now();
    if (std::exchange(ignore_ok_, false)) return;
    silences_ = 0;
    probing_ = false;
    adapt_window(line);
    if (begins(line, "ok N")) {
        const std::string_view rest = line.substr(4);
        if (const auto number = whole_number(rest.substr(0, rest.find(' ')))) {
            while (!outstanding_.empty() && outstanding_.front().number <= *number) {
                outstanding_bytes_ -= outstanding_.front().bytes;
                outstanding_.pop_front();
            }
            return;
        }
    }
    if (outstanding_.empty()) return;
    outstanding_bytes_ -= outstanding_.front().bytes;
    outstanding_.pop_front();
}

/// ADVANCED_OK: `B` is the number of free places. The number free while nothing else was in flight is the total.
void Link::adapt_window(std::string_view answer) {
    const std::size_t at = answer.rfind(" B");
    if (at == std::string_view::npos || outstanding_.size() > 1) return;
    const auto places = whole_number(answer.substr(at + 2));
    if (!places || *places > 64) return;
    window_lines_ = std::clamp(static_cast<int>(*places), 1, options_.window_lines);
}

/// Idle firmware that sends `wait` has answered everything: outstanding answers are lost.
void Link::handle_wait() {
    constexpr double under_way_s = 0.5;
    if (connected_ && !outstanding_.empty() && !wanted_ && clock_.now() - last_write_s_ > under_way_s)
        (void)give_up_waiting();
}

// Recovery.

/// The rate of errors caught by the checksum gives an estimate of those that it misses.
Status Link::note_refusal() {
    refused_ += 1 / recent_lines;
    if (refused_ <= options_.most_refused) return {};
    return failure(
        "the wire damages {:.0f} % of the lines: at that rate its checksum lets some through, so nothing more is sent; "
        "look at cable, plugs and ground",
        100 * refused_);
}

/// Lines in flight after a bad one are refused one by one; the state is known only when the wire is quiet.
Status Link::resynchronise() {
    // After a silence it may turn out that only answers were lost: then no line was damaged.
    const bool only_answers = probing_ && *wanted_ == next_to_send_;
    if (Status status = only_answers ? Status{} : note_refusal(); !status) return status;
    if (Status status = wait_until_quiet(); !status) return status;
    ignore_ok_ = false;
    const long number = *std::exchange(wanted_, std::nullopt);
    return go_back_to(number);
}

Status Link::go_back_to(long number) {
    // Its `start` was missed: line 1 is requested although more lines were sent than could be accepted without it.
    if (number == 1 && (base_ > 0 || next_to_send_ > 1 + options_.window_lines)) return handle_restart();
    if (number > next_number_ || number <= base_) {
        return failure("the printer requests line {}; only lines {} to {} can be sent again", number, base_ + 1,
                       next_number_ - 1);
    }
    repeats_ = number == repeated_ ? repeats_ + 1 : 0;
    repeated_ = number;
    if (repeats_ > options_.most_repeats) {
        return failure("line {} was refused {} times: the wire is too noisy", number, repeats_);
    }
    resends_ += next_to_send_ > number ? next_to_send_ - number : 0;
    next_to_send_ = number;
    // Lines before it have arrived and their `ok`s are still due, unless a long silence showed that these are lost.
    const bool lost = std::exchange(probing_, false);
    drop_outstanding([&](long n) { return lost || n >= number; });
    return {};
}

/// Asks for the last line that the firmware has accepted. (Repeating one would not tell: since 2.1.2 a line that is
/// among the last two accepted is silently ignored.)
Status Link::give_up_waiting() {
    if (++silences_ > options_.most_repeats) return failure("the printer has stopped answering");
    answer_s_ = clock_.now();
    if (outstanding_.empty()) {
        silent_ = true;
        return {};
    }
    probing_ = true;
    return put_probe();
}

}  // namespace pliant::host
