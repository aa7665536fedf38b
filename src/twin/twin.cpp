#include "twin/twin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace pliant::twin {
namespace {

constexpr std::size_t queue_lines = 4;     // Marlin's BUFSIZE
constexpr std::size_t buffer_bytes = 127;  // RX_BUFFER_SIZE 128 holds one less
constexpr std::size_t longest_raw_line = 4096;

/// Somewhere in the middle of every travel: nobody knows until the axes are homed.
machine::Position unknown_start(const machine::Printer& printer) {
    machine::Position start;
    for (const machine::Axis axis : machine::all_axes) {
        start[axis] = printer.axis(axis).min_um + (printer.axis(axis).max_um - printer.axis(axis).min_um) / 2;
    }
    start[machine::Axis::carriage] = printer.carriage.print_um;
    start[machine::Axis::table] = printer.table.stations_um.empty() ? 0 : printer.station_um(1);
    return start;
}

std::string_view without_blanks(std::string_view line) {
    while (!line.empty() && (line.front() == ' ' || line.front() == '\r')) line.remove_prefix(1);
    while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.remove_suffix(1);
    return line;
}

}  // namespace

Twin::Twin(const machine::Printer& printer, Options options)
    : printer_(printer), options_(std::move(options)), motors_(printer_, unknown_start(printer_)), cure_(printer_) {
    say("start");
    say("echo:PowerUp");
}

void Twin::say(std::string_view line) {
    output_ += line;
    output_ += '\n';
}

std::string Twin::take_output() {
    return std::exchange(output_, {});
}

bool Twin::fault_hits(Fault::Kind kind, int n) const {
    return std::any_of(options_.faults.begin(), options_.faults.end(),
                       [&](const Fault& f) { return f.kind == kind && f.n == n; });
}

void Twin::say_ok(const Queued& queued) {
    if (fault_hits(Fault::Kind::lose_ok, ++oks_)) return;
    if (!options_.advanced_ok) return say("ok");
    const auto room = queue_lines - std::min(queue_lines, queue_.size());
    say(queued.number ? fmt::format("ok N{} P15 B{}", *queued.number, room) : fmt::format("ok P15 B{}", room));
}

void Twin::violation(const std::string& what) {
    log_.violations.push_back(fmt::format("{:.3f} s: {}", now_s_, what));
    say("Error:interlock: " + what);
}

// --- the receiving end ---------------------------------------------------------------------------------------------

void Twin::receive(std::string_view bytes) {
    for (const char byte : bytes) {
        if (arriving_.size() < longest_raw_line) arriving_ += byte;
        if (byte == '\n') take_line(std::exchange(arriving_, {}));
    }
}

/// A whole line has arrived: faults, then the emergency parser, then the receive buffer.
void Twin::take_line(std::string line) {
    ++lines_;
    if (fault_hits(Fault::Kind::reset, lines_)) return reset();
    if (dead_ || fault_hits(Fault::Kind::lose_line, lines_)) return;
    if (fault_hits(Fault::Kind::corrupt_byte, lines_) && line.size() > 2) line[line.size() / 2] ^= 4;
    const std::string_view plain = without_blanks(std::string_view(line).substr(0, line.size() - 1));
    if (plain == "M112") return kill();
    if (plain == "M410") quick_stop();
    buffer_ += line.substr(0, buffer_bytes - std::min(buffer_bytes, buffer_.size()));
    drain();
    advance_to(now_s_);
}

/// Moves lines from the receive buffer into the command queue, as long as there is room.
void Twin::drain() {
    while (!buffer_.empty() && queue_.size() < queue_lines) {
        const auto line = reader_.feed(buffer_.front());
        buffer_.erase(0, 1);
        if (!line) continue;
        if (line->error.empty()) {
            queue_.push_back({line->command, line->number});
        } else {
            refuse(*line);
        }
    }
}

/// Error, request, and an ok that acknowledges nothing; what else has arrived is thrown away.
void Twin::refuse(const ReceivedLine& line) {
    ++log_.bad_lines;
    buffer_.clear();
    say(fmt::format("Error:{}, Last Line: {}", line.error, reader_.last_number()));
    if (!fault_hits(Fault::Kind::lose_resend, ++resends_)) say(fmt::format("Resend: {}", reader_.last_number() + 1));
    say("ok");
}

void Twin::kill() {
    dead_ = true;
    motors_.release(now_s_);
    queue_.clear();
    buffer_.clear();
    running_.reset();
    say("echo:M112 Shutdown");
    say("Error:Printer halted. kill() called!");
    say("//action:poweroff");
}

void Twin::quick_stop() {
    motors_.stop(now_s_);
    if (!running_) return;
    running_->done_at_s = now_s_;
    // An interrupted homing has homed nothing.
    if (running_->command && running_->command->is('G', 28)) running_->command = machine::Command{'M', 400, {}, {}};
}

void Twin::reset() {
    ++log_.resets;
    motors_.release(now_s_);
    reader_.reset();
    buffer_.clear();
    arriving_.clear();
    queue_.clear();
    running_.reset();
    dead_ = false;
    idle_limit_s_ = 120;
    pump_on_ = false;
    say("start");
    say("echo: External Reset");
}

// --- the clock -----------------------------------------------------------------------------------------------------

std::optional<double> Twin::next_event() const {
    if (!running_) return std::nullopt;
    return std::min(running_->done_at_s, running_->next_busy_s);
}

void Twin::advance_to(double seconds) {
    for (;;) {
        if (!running_ && !queue_.empty()) start_next();
        const auto next = next_event();
        if (!next || *next > seconds) break;
        now_s_ = std::max(now_s_, *next);
        if (running_->done_at_s <= now_s_) {
            finish_running();
        } else {
            say("echo:busy: processing");
            running_->next_busy_s += options_.busy_every_s;
        }
    }
    now_s_ = std::max(now_s_, seconds);
}

void Twin::start_next() {
    Running running{queue_.front(), std::nullopt, now_s_, now_s_ + options_.busy_every_s};
    queue_.pop_front();
    if (auto command = machine::parse_command(running.queued.line)) {
        running.done_at_s = blocks_until(*command);
        running.command = std::move(*command);
    }
    running_ = std::move(running);
    drain();
}

void Twin::finish_running() {
    const Running done = std::move(*running_);
    running_.reset();
    if (done.command) {
        execute(*done.command, done.queued);
    } else {
        say(fmt::format("echo:Unknown command: \"{}\"", done.queued.line));
    }
    if (!dead_) say_ok(done.queued);
    drain();
}

// --- light ---------------------------------------------------------------------------------------------------------

void Twin::light_on(const job::Image& image) {
    if (shown_) light_off();
    ++log_.exposures;
    const bool fits =
        image.width_px == printer_.projector.width_px && image.height_px == printer_.projector.height_px &&
        image.pixels.size() == static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px);
    if (!fits) return violation("an image that is not of the projector's size");
    if (Status status = motors_.interlock().light_on(motors_.moving(now_s_)); !status) {
        return violation(status.error().message);
    }
    shown_ = image;
    shown_since_s_ = now_s_;
    shown_vat_ = interlock().hooked_vat().value_or(-1);
    sprayed_s_ = 0;
}

void Twin::light_off() {
    motors_.interlock().light_off();
    if (!shown_) return;
    cure_.expose(*shown_, shown_vat_, now_s_ - shown_since_s_, interlock().position()[machine::Axis::platform]);
    shown_.reset();
}

const Cure& Twin::cured() {
    cure_.finish();
    return cure_;
}

}  // namespace pliant::twin
