#include "printing/twin/twin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <utility>

namespace pliant::twin {
namespace {

constexpr std::size_t queue_lines = 4;     // Marlin's BUFSIZE
constexpr std::size_t buffer_bytes = 127;  // one less than RX_BUFFER_SIZE of 128
constexpr std::size_t longest_raw_line = 4096;
constexpr double never = std::numeric_limits<double>::infinity();
constexpr double runs_on_s = 0.9;   // measured on a Mega: until the last step of a move after an M112 alone
constexpr double quick_stop_s = 1;  // time after M410 in which the planner accepts no move

/// In the middle of every travel: the true position is unknown until the axes are homed.
machine::Position unknown_start(const machine::Printer& printer) {
    machine::Position start;
    for (const machine::Axis axis : machine::all_axes) {
        start[axis] = printer.axis(axis).min_um + (printer.axis(axis).max_um - printer.axis(axis).min_um) / 2;
    }
    start[machine::Axis::carriage] = printer.carriage.print_um;
    start[machine::Axis::table] = printer.has_table() ? printer.station_um(1) : 0;
    return start;
}

std::string_view without_blanks(std::string_view line) {
    while (!line.empty() && (line.front() == ' ' || line.front() == '\r')) line.remove_prefix(1);
    while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.remove_suffix(1);
    return line;
}

}  // namespace

Twin::Twin(const machine::Printer& printer, Options options)
    : printer_(printer),
      options_(std::move(options)),
      screen_(printer_.projector, options_.mask),
      occurred_(options_.faults.size(), false),
      motors_(printer_, unknown_start(printer_)),
      cure_(printer_),
      fluids_(printer_),
      busy_every_s_(options_.busy_every_s),
      fan_since_s_(printer_.fans.size(), -1) {
    log_.fan_s.resize(printer_.fans.size());
    for (std::size_t i = 0; i < printer_.vats.size(); ++i) {
        if (fault_hits(Fault::Kind::empty_vat, printer_.vats[i].slot)) cure_.set_level_ml(static_cast<int>(i), 0);
    }
    if (options_.boot_s > 0)
        boots_at_s_ = options_.boot_s;
    else
        boot();
}

/// The first messages of the firmware; `echo:` and `//` lines are for people.
void Twin::boot() {
    boots_at_s_.reset();
    say("start");
    say(log_.resets == 0 ? "PowerUp" : "External Reset");
    say("Marlin dialect of the Pliant twin");
    say("echo: Free Memory: 4096  PlannerBufferBytes: 1584");
    say("//action:prompt_end");
    next_wait_s_ = now_s_ + options_.wait_every_s;
}

void Twin::say(std::string_view line) {
    output_ += line;
    output_ += '\n';
}

std::string Twin::take_output() {
    return std::exchange(output_, {});
}

const Fault* Twin::fault_at(Fault::Kind kind, int n) const {
    const auto found = std::find_if(options_.faults.begin(), options_.faults.end(),
                                    [&](const Fault& f) { return f.kind == kind && f.n == n; });
    if (found == options_.faults.end()) return nullptr;
    occurred_[static_cast<std::size_t>(found - options_.faults.begin())] = true;
    return &*found;
}

std::vector<std::string> Twin::missed_faults() const {
    std::vector<std::string> missed;
    for (std::size_t i = 0; i < options_.faults.size(); ++i) {
        if (!occurred_[i]) missed.push_back(fault_text(options_.faults[i]));
    }
    return missed;
}

void Twin::say_ok(const Queued& queued, std::string_view data) {
    if (fault_hits(Fault::Kind::lose_ok, ++oks_)) return;
    if (!options_.advanced_ok) return say(fmt::format("ok{}", data));
    const auto room = queue_lines - std::min(queue_lines, queue_.size());
    const std::string number = queued.number ? fmt::format(" N{}", *queued.number) : "";
    say(fmt::format("ok{} P15 B{}{}", number, room, data));
}

void Twin::violation(const std::string& what) {
    log_.violations.push_back(fmt::format("{:.3f} s: {}", now_s_, what));
    say("Error:interlock: " + what);
}

// The receiving end.

void Twin::mishap(const std::string& what) {
    log_.mishaps.push_back(fmt::format("{:.3f} s: {}", now_s_, what));
}

void Twin::receive(std::string_view bytes) {
    for (char byte : bytes) {
        ++bytes_;
        if (boots_at_s_ || fault_hits(Fault::Kind::lose_byte, bytes_)) continue;
        if (fault_hits(Fault::Kind::flip_byte, bytes_)) byte = static_cast<char>(byte ^ 4);
        if (arriving_.size() < longest_raw_line) arriving_ += byte;
        if (byte == '\n') take_line(std::exchange(arriving_, {}));
    }
}

/// Handles a complete line: faults, then the emergency parser, then the receive buffer.
void Twin::take_line(std::string line) {
    if (line == "\n" || line == "\r\n") return;  // empty, and not counted for faults
    ++lines_;
    if (fault_hits(Fault::Kind::reset, lines_)) return reset();
    if (dead_ || fault_hits(Fault::Kind::lose_line, lines_)) return;
    if (line.front() == 'N' && fault_hits(Fault::Kind::lose_number, lines_)) line.erase(0, line.find(' ') + 1);
    if (line.size() > 2 && fault_hits(Fault::Kind::corrupt_byte, lines_)) line[line.size() / 2] ^= 4;
    if (const Fault* f = fault_at(Fault::Kind::stall, lines_))
        stalled_until_s_ = now_s_ + (f->amount > 0 ? f->amount : 30);
    if (const Fault* f = fault_at(Fault::Kind::resend_loop, lines_))
        refuse_more_ = f->amount > 0 ? static_cast<int>(f->amount) : 3;
    const std::string_view plain = without_blanks(std::string_view(line).substr(0, line.size() - 1));
    if (options_.emergency_parser) {
        if (plain == "M112") return kill("echo:M112 Shutdown");
        if (plain == "M410") quick_stop();
        if (plain == "M108") user_continues();
    }
    buffer_ += line.substr(0, buffer_bytes - std::min(buffer_bytes, buffer_.size()));
    drain();
    advance_to(now_s_);
}

/// Moves lines from the receive buffer to the command queue while there is room.
void Twin::drain() {
    while (!buffer_.empty() && queue_.size() < queue_lines && now_s_ >= stalled_until_s_) {
        const long last = reader_.last_number();
        auto line = reader_.feed(buffer_.front());
        buffer_.erase(0, 1);
        if (!line) continue;
        if (line->error.empty() && line->number && refuse_more_ > 0) {
            --refuse_more_;
            reader_.set_last_number(last);
            line->error = "checksum mismatch";
        }
        if (line->error.empty()) {
            queue_.push_back({line->command, line->number});
        } else {
            refuse(*line);
        }
    }
}

/// Sends an error, a resend request, and an `ok` without meaning; discards what else has arrived.
void Twin::refuse(const ReceivedLine& line) {
    if (!line.is_question) ++log_.bad_lines;
    buffer_.clear();
    say(fmt::format("Error:{}, Last Line: {}", line.error, reader_.last_number()));
    if (!fault_hits(Fault::Kind::lose_resend, ++resends_)) say(fmt::format("Resend: {}", reader_.last_number() + 1));
    say("ok");
}

/// A killed firmware reports it and reads nothing more. Moves in progress continue for a while.
void Twin::kill(std::string_view why) {
    note_push();
    dead_ = true;
    queue_.clear();
    buffer_.clear();
    running_.reset();
    say(why);
    say("Error:Printer halted. kill() called!");
    say("//action:poweroff");
    if (!motors_.moving(now_s_)) return let_go();
    lets_go_s_ = now_s_ + runs_on_s;
}

/// Switches everything off; the relay of the emergency line, if any, drops.
void Twin::let_go() {
    lets_go_s_.reset();
    outputs_off();
    log_.power_cut = printer_.emergency_line.signal == machine::EmergencyLine::Signal::controller;
    lose_power();
}

/// Homing to a dead switch ends here, for whatever reason.
void Twin::note_push() {
    if (!running_ || now_s_ <= running_->reaches_end_s) return;
    log_.pushed_s += now_s_ - running_->reaches_end_s;
    mishap(fmt::format("an axis pushed against the end of its travel for {:.0f} s", now_s_ - running_->reaches_end_s));
}

void Twin::outputs_off() {
    pump_on_ = false;
    for (std::size_t i = 0; i < fan_since_s_.size(); ++i) {
        if (fan_since_s_[i] >= 0) log_.fan_s[i] += now_s_ - fan_since_s_[i];
        fan_since_s_[i] = -1;
    }
}

/// Queued commands are executed later: after a stop the planner accepts nothing for a second.
void Twin::quick_stop() {
    motors_.stop(now_s_);
    held_until_s_ = now_s_ + quick_stop_s;
    if (!running_) return;
    note_push();
    running_->reaches_end_s = never;
    running_->done_at_s = held_until_s_;
    // An interrupted homing has homed nothing; an interrupted pause has ended.
    if (running_->command && running_->command->is('G', 28)) running_->command = machine::Command{'M', 400, {}, {}};
}

/// M108: ends a pause for the user.
void Twin::user_continues() {
    if (!running_ || !running_->command) return;
    if (running_->command->is('M', 0) || running_->command->is('M', 1)) running_->done_at_s = now_s_;
}

void Twin::reset() {
    ++log_.resets;
    note_push();
    lets_go_s_.reset();
    held_until_s_ = 0;
    lose_power();
    reader_.reset();
    buffer_.clear();
    arriving_.clear();
    queue_.clear();
    running_.reset();
    dead_ = false;
    idle_limit_s_ = 120;
    soft_endstops_ = true;
    busy_every_s_ = options_.busy_every_s;
    outputs_off();
    log_.power_cut = false;
    stalled_until_s_ = 0;
    if (options_.boot_s > 0)
        boots_at_s_ = now_s_ + options_.boot_s;
    else
        boot();
}

// The clock.

/// When an idle firmware sends or does something by itself; infinite if never.
double Twin::idle_event() const {
    if (!queue_.empty() || !buffer_.empty()) return std::max(stalled_until_s_, held_until_s_);
    return options_.wait_every_s > 0 && !dead_ ? next_wait_s_ : never;
}

std::optional<double> Twin::next_event() const {
    if (boots_at_s_) return boots_at_s_;
    if (lets_go_s_) return lets_go_s_;
    const double next = running_ ? std::min(running_->done_at_s, running_->next_busy_s) : idle_event();
    if (next == never) return std::nullopt;
    return std::max(next, stalled_until_s_);
}

void Twin::advance_to(double seconds) {
    for (;;) {
        if (now_s_ >= stalled_until_s_) drain();
        if (!running_ && !queue_.empty() && now_s_ >= std::max(stalled_until_s_, held_until_s_)) start_next();
        const auto next = next_event();
        if (!next || *next > seconds) break;
        now_s_ = std::max(now_s_, *next);
        if (boots_at_s_) {
            boot();
        } else if (lets_go_s_) {
            let_go();
        } else if (running_ && running_->done_at_s <= now_s_) {
            finish_running();
        } else if (running_) {
            const bool pause = running_->command && running_->command->letter == 'M' && running_->command->number <= 1;
            say(pause ? "echo:busy: paused for user" : "echo:busy: processing");
            running_->next_busy_s = busy_every_s_ > 0 ? now_s_ + busy_every_s_ : never;
        } else if (queue_.empty() && buffer_.empty()) {
            say("wait");
            next_wait_s_ = now_s_ + options_.wait_every_s;
        }
    }
    now_s_ = std::max(now_s_, seconds);
}

void Twin::start_next() {
    Running running{queue_.front(), std::nullopt, now_s_, busy_every_s_ > 0 ? now_s_ + busy_every_s_ : never, never};
    queue_.pop_front();
    if (auto command = machine::parse_command(running.queued.line)) {
        running.done_at_s = blocks_until(*command);
        running.command = std::move(*command);
        if (running.command->is('G', 28)) plan_homing(running);
    }
    running_ = std::move(running);
    drain();
}

void Twin::finish_running() {
    note_push();
    const Running done = std::move(*running_);
    running_.reset();
    const bool z_move = options_.z_sync && done.command && (done.command->is('G', 0) || done.command->is('G', 1)) &&
                        done.command->has(printer_.axis(machine::Axis::platform).letter);
    if (z_move && done.synced) {
        say("Z_move_comp");
    } else if (done.command) {
        execute(*done.command);
        if (z_move && !dead_) {
            running_ = done;
            running_->synced = true;
            running_->done_at_s = std::max(now_s_, motors_.done_at());
            return;
        }
    } else {
        say(fmt::format("echo:Unknown command: \"{}\"", done.queued.line));
    }
    const bool temperature = done.command && done.command->is('M', 105);
    if (!dead_) say_ok(done.queued, temperature ? " T:0.00 /0.00 @:0" : "");
    next_wait_s_ = now_s_ + options_.wait_every_s;
    drain();
}

}  // namespace pliant::twin
