// Execution of the virtual printer's commands; the wire and the clock are in twin.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "printing/machine/switches.hpp"
#include "printing/twin/twin.hpp"

namespace pliant::twin {
namespace {

using machine::Axis;
using machine::Command;

/// Commands that are accepted but change nothing in the model.
bool is_quiet(const Command& c) {
    constexpr std::array<int, 5> numbers = {82, 105, 108, 110, 302};
    return c.letter == 'M' && std::find(numbers.begin(), numbers.end(), c.number) != numbers.end();
}

double dwell_seconds(const Command& c) {
    if (const auto seconds = c.value('S')) return std::clamp(*seconds, 0.0, 86400.0);
    return std::clamp(c.value('P').value_or(0) / 1000, 0.0, 86400.0);
}

}  // namespace

std::uint64_t path_after(std::uint64_t path, const machine::Position& to) {
    for (const int um : to.um) {
        for (int shift = 0; shift < 32; shift += 8)
            path = (path ^ (static_cast<std::uint32_t>(um) >> shift & 255U)) * 1099511628211ULL;
    }
    return path;
}

std::vector<Axis> Twin::axes_to_home(const Command& command) const {
    std::vector<Axis> axes;
    for (const machine::Word& word : command.words) {
        if (const auto axis = machine::axis_of_letter(printer_, word.letter)) axes.push_back(*axis);
    }
    if (axes.empty()) axes = machine::homing_order(printer_);
    return axes;
}

/// When the command is done and its `ok` is sent.
double Twin::blocks_until(const Command& c) {
    const double still = std::max(now_s_, motors_.done_at());
    if (c.is('G', 0) || c.is('G', 1)) return motors_.room_at(now_s_);
    if (c.is('G', 4)) return still + dwell_seconds(c);
    if (c.is('M', 400)) return still;
    if (c.is('M', 0) || c.is('M', 1)) {
        for (const char* line : {"prompt_end", "prompt_begin M0 Stop", "prompt_button Continue", "prompt_show"}) {
            say(fmt::format("//action:{}", line));
        }
        return std::numeric_limits<double>::infinity();
    }
    return c.is('G', 28) ? still : now_s_;
}

/// Whether the home switch of the axis is dead, that is, never pressed.
bool Twin::is_dead(Axis axis) const {
    const std::vector<machine::LimitSwitch> switches = machine::switches_of(printer_);
    for (std::size_t i = 0; i < switches.size(); ++i) {
        const bool homes_here = switches[i].axis == axis && switches[i].at_max == printer_.axis(axis).homes_to_max;
        if (homes_here && fault_hits(Fault::Kind::dead_switch, static_cast<int>(i) + 1)) return true;
    }
    return false;
}

/// Computes the duration of homing. With a dead switch Marlin moves one and a half times the travel, and pushes against
/// the end.
void Twin::plan_homing(Running& running) {
    for (const Axis axis : axes_to_home(*running.command)) {
        const double seconds = motors_.home_seconds(axis);
        if (!is_dead(axis)) {
            running.done_at_s += seconds;
            continue;
        }
        const machine::AxisSpec& spec = printer_.axis(axis);
        running.reaches_end_s = running.done_at_s + seconds;
        running.done_at_s += 1.5 * (spec.max_um - spec.min_um) / 1000.0 / spec.homing_speed_mm_s;
        return;
    }
}

void Twin::execute(const Command& c) {
    if (c.is('G', 0) || c.is('G', 1)) return execute_move(c);
    if (c.is('G', 28)) return execute_home(c);
    if (c.is('G', 92)) return execute_set(c);
    if (c.is('M', 106) || c.is('M', 107) || c.is('M', 42)) return execute_switch(c);
    if (c.is('G', 4) || c.is('G', 90) || c.is('M', 400) || is_quiet(c)) {
        // A numbered M110 already set the number when it was received: it acts twice.
        if (const auto number = c.value('N'); number && c.is('M', 110))
            reader_.set_last_number(static_cast<long>(std::clamp(*number, -2147483648.0, 2147483647.0)));
        return;
    }
    execute_other(c);
}

/// Soft endstops: a homed axis stops at the end of its travel, without a message from the firmware.
machine::Position Twin::clamped(machine::Position to) {
    if (!soft_endstops_) return to;
    const machine::Position asked = to;
    for (const Axis axis : machine::all_axes) {
        const machine::AxisSpec& spec = printer_.axis(axis);
        if (spec.present() && interlock().homed(axis)) to[axis] = std::clamp(to[axis], spec.min_um, spec.max_um);
    }
    if (to == asked) return to;
    ++log_.clamped_moves;
    log_.violations.push_back(fmt::format("{:.3f} s: a move beyond an axis' travel, cut short", now_s_));
    return to;
}

void Twin::execute_move(const Command& c) {
    // Motors that were idle for too long have been disabled silently.
    if (idle_limit_s_ > 0 && now_s_ - motors_.done_at() > idle_limit_s_) motors_.release(now_s_);
    if (const std::string letters = not_homed(c); options_.homes_first && !letters.empty())
        return say(fmt::format("echo:Home {} First", letters));
    if (const auto feed = c.value('F'); feed && *feed > 0) feed_mm_s_ = *feed / 60;
    const auto asked = machine::move_target(printer_, c, interlock().position());
    if (!asked) return violation(asked.error().message);
    const machine::Position target = clamped(*asked);
    const machine::Position from = interlock().position();
    if (target == from) return;
    const std::optional<int> vat = interlock().hooked_vat(), tray = interlock().tray_vat();
    if (Status status = settling_.check(from, target, std::max(now_s_, motors_.done_at())); !status)
        return violation(status.error().message);
    if (Status status = motors_.move(now_s_, target, feed_mm_s_); !status) return violation(status.error().message);
    ++log_.moves;
    log_.path = path_after(log_.path, target);
    const int slip_um = slip_um_[static_cast<std::size_t>(Axis::platform)];
    brush_.move(from, target, interlock().part_height_um() - slip_um);
    miss_steps(from, target);
    miss_vat(tray);
    note_vat(vat);
}

/// The motor of the first axis that moves falls short, unnoticed by the controller.
void Twin::miss_steps(const machine::Position& from, const machine::Position& to) {
    const Fault* fault = fault_at(Fault::Kind::missed_steps, ++moves_);
    if (fault == nullptr) return;
    for (const Axis axis : machine::all_axes) {
        if (from[axis] == to[axis]) continue;
        const int um = static_cast<int>(std::lround((fault->amount > 0 ? fault->amount : 1) * 1000));
        slip_um_[static_cast<std::size_t>(axis)] += to[axis] > from[axis] ? -um : um;
        return mishap(
            fmt::format("the {} misses {:.3f} mm of its way", machine::axis_name(axis, printer_.store()), um / 1000.0));
    }
}

/// The letters of axes in the move that are not homed.
std::string Twin::not_homed(const Command& command) const {
    std::string letters;
    for (const Axis axis : machine::all_axes) {
        const machine::AxisSpec& spec = printer_.axis(axis);
        if (spec.present() && command.has(spec.letter) && !interlock().homed(axis)) letters += spec.letter;
    }
    return letters;
}

void Twin::execute_home(const Command& c) {
    for (const Axis axis : axes_to_home(c)) {
        if (is_dead(axis)) return kill("echo:Homing Failed");
        ++log_.homings;
        if (Status status = motors_.home(now_s_, axis); !status) violation(status.error().message);
        slip_um_[static_cast<std::size_t>(axis)] = 0;
    }
}

/// G92 replaces homing if a person has placed the axis at its home position; otherwise it would shift the origin.
void Twin::execute_set(const Command& c) {
    for (const machine::Word& word : c.words) {
        const auto axis = machine::axis_of_letter(printer_, word.letter);
        if (!axis || !printer_.axis(*axis).homes_by_hand) {
            violation(fmt::format("G92 moves the origin of {}", word.letter));
            continue;
        }
        if (Status status = motors_.home(now_s_, *axis); !status) violation(status.error().message);
    }
}

/// Switching is queued with the moves: it takes effect when those before it are done.
void Twin::execute_switch(const Command& c) {
    if (machine::moves_emergency_line(printer_, c))
        return violation(fmt::format("M42 P{}: that pin is the emergency line", printer_.emergency_line.pin));
    const bool fan = !c.is('M', 42);
    if (fan && options_.report_fans) {
        say(fmt::format("M106 P{:g} S{:g}", c.value('P').value_or(0), c.is('M', 107) ? 0 : c.value('S').value_or(255)));
    }
    const double at_s = std::max(now_s_, motors_.done_at());
    switch_fans(c, at_s);
    if (const auto on = machine::switched(printer_.pump, c)) return switch_pump(*on, at_s);
    switch_latch(c, at_s);
}

void Twin::switch_pump(bool on, double at_s) {
    if (on == pump_on_) return;
    if (Status status = motors_.interlock().pump(on); !status) return violation(status.error().message);
    pump_on_ = on;
    if (pump_on_) {
        pump_since_s_ = at_s;
        if (fault_hits(Fault::Kind::dead_pump, ++pump_starts_)) {
            pump_works_ = false;
            mishap("the pump moves nothing");
        }
    } else if (pump_works_) {
        spray_until(at_s);
    }
}

/// The pump stops. If it has drawn air, it has cleaned nothing.
void Twin::spray_until(double at_s) {
    fluids_.advance_to(at_s);
    if (fluids_.solution().draws_air()) {
        if (!drew_air_) mishap("the pump draws air: the cleaning solution does not cover it");
        drew_air_ = true;
        return;
    }
    drew_air_ = false;
    const double seconds = at_s - pump_since_s_;
    sprayed_s_ += seconds;
    residue_ *= fluids_.clean(seconds, sprayed_.removed(cure_, seconds));
}

void Twin::switch_fans(const Command& c, double at_s) {
    for (std::size_t i = 0; i < printer_.fans.size(); ++i) {
        const auto on = machine::switched(printer_.fans[i], c);
        if (!on || *on == (fan_since_s_[i] >= 0)) continue;
        if (!*on) log_.fan_s[i] += at_s - fan_since_s_[i];
        fan_since_s_[i] = *on ? at_s : -1;
    }
}

void Twin::execute_other(const Command& c) {
    if (c.is('M', 84) || c.is('M', 18) || c.is('M', 85)) {
        if (const auto limit = c.value('S'))
            idle_limit_s_ = *limit;
        else if (!c.is('M', 85))
            motors_.release(now_s_);
    } else if (c.is('M', 113)) {
        if (const auto every = c.value('S'))
            busy_every_s_ = std::clamp(*every, 0.0, 60.0);
        else
            say(fmt::format("echo:M113 S{:g}", busy_every_s_));
    } else if (c.is('M', 112)) {
        kill("echo:M112 Shutdown");
    } else if (c.is('M', 410)) {
        if (!options_.emergency_parser) quick_stop();
    } else if (c.is('M', 999)) {
        // Observed: an unprovoked resend request, and an `ok` for it in addition to the command's own.
        if (c.value('S')) return;
        say(fmt::format("Resend: {}", reader_.last_number() + 1));
        say("ok");
    } else {
        execute_query(c);
    }
}

void Twin::execute_query(const Command& c) {
    if (c.is('M', 114)) {
        std::string line;
        for (const Axis axis : machine::all_axes) {
            if (!printer_.axis(axis).present()) continue;
            line += fmt::format("{}:{:.3f} ", printer_.axis(axis).letter, interlock().position()[axis] / 1000.0);
        }
        say(line);
    } else if (c.is('M', 115)) {
        say("FIRMWARE_NAME:Pliant twin, Marlin dialect PROTOCOL_VERSION:1.0 MACHINE_TYPE:" + printer_.name +
            " EXTRUDER_COUNT:0");
        for (const char* capability : {"SERIAL_XON_XOFF:0", "EEPROM:0", "AUTOREPORT_TEMP:0", "SDCARD:0"})
            say(fmt::format("Cap:{}", capability));
        const bool holds_power = printer_.emergency_line.signal == machine::EmergencyLine::Signal::controller;
        say(fmt::format("Cap:SOFTWARE_POWER:{}", holds_power ? 1 : 0));
        say(fmt::format("Cap:EMERGENCY_PARSER:{}", options_.emergency_parser ? 1 : 0));
    } else if (c.is('M', 119)) {
        say_switches();
    } else if (c.is('M', 503)) {
        say_settings();
    } else if (c.is('M', 211)) {
        if (const auto on = c.value('S'))
            soft_endstops_ = *on != 0;
        else
            say_soft_endstops();
    } else if (c.is('M', 118)) {
        say(fmt::format("{}{}", c.value('E') == 1 ? "echo:" : (c.value('A') == 1 ? "//" : ""), c.text));
    } else if (c.is('M', 0) || c.is('M', 1)) {
        say("//action:prompt_end");
    } else {
        say(fmt::format("echo:Unknown command: \"{}{}\"", c.letter, c.number));
    }
}

/// In Marlin's report format: comments and commands, every axis by its letter.
void Twin::say_settings() {
    const auto row = [&](const char* heading, const char* code, const auto& value) {
        say(fmt::format("echo:; {}:", heading));
        std::string line = fmt::format("echo:  {}", code);
        for (const Axis axis : machine::all_axes) {
            const machine::AxisSpec& spec = printer_.axis(axis);
            if (spec.present()) line += fmt::format(" {}{:.2f}", spec.letter, value(spec));
        }
        say(line);
    };
    using machine::AxisSpec;
    constexpr double unknown_steps_per_mm = 80;
    row("Steps per unit", "M92",
        [&](const AxisSpec& a) { return a.drive.known() ? a.drive.steps_per_mm() : unknown_steps_per_mm; });
    row("Max feedrates (units/s)", "M203", [](const AxisSpec& a) { return a.speed_mm_s; });
    row("Max Acceleration (units/s2)", "M201", [](const AxisSpec& a) { return a.acceleration_mm_s2; });
    double most = 0;
    for (const AxisSpec& axis : printer_.axes) most = axis.present() ? std::max(most, axis.acceleration_mm_s2) : most;
    say("echo:; Acceleration (units/s2) (P<print-accel> R<retract-accel> T<travel-accel>):");
    say(fmt::format("echo:  M204 P{:.2f} R{:.2f} T{:.2f}", most, most, most));
    row("Home offset", "M206", [](const AxisSpec&) { return 0.0; });
    say_soft_endstops();
}

void Twin::say_soft_endstops() {
    std::string low, high;
    for (const Axis axis : machine::all_axes) {
        const machine::AxisSpec& spec = printer_.axis(axis);
        if (!spec.present()) continue;
        low += fmt::format(" {}{:.2f}", spec.letter, spec.min_um / 1000.0);
        high += fmt::format(" {}{:.2f}", spec.letter, spec.max_um / 1000.0);
    }
    say("echo:; Soft endstops:");
    say(fmt::format("echo:  M211 S{} ; {}", soft_endstops_ ? 1 : 0, soft_endstops_ ? "ON" : "OFF"));
    say(fmt::format("echo:  Min: {}   Max: {}", low, high));
}

/// By the actual position of the axis, whatever the controller assumes; homed or not.
bool Twin::is_pressed(const machine::LimitSwitch& limit) const {
    const machine::AxisSpec& spec = printer_.axis(limit.axis);
    if (limit.at_max == spec.homes_to_max && is_dead(limit.axis)) return false;
    const int at_um = motors_.position_at(now_s_)[limit.axis] + slip_um_[static_cast<std::size_t>(limit.axis)];
    return limit.at_max ? at_um >= spec.max_um : at_um <= spec.min_um;
}

void Twin::say_switches() {
    say("Reporting endstop status");
    const auto tell = [&](const std::string& name, bool pressed) {
        say(fmt::format("{}: {}", name, pressed ? "TRIGGERED" : "open"));
    };
    const std::vector<machine::LimitSwitch> switches = machine::switches_of(printer_);
    for (std::size_t i = 0; i < switches.size(); ++i) {
        const bool stuck = fault_hits(Fault::Kind::stuck_switch, static_cast<int>(i) + 1);
        tell(machine::switch_names(printer_, switches[i]).front(), stuck || is_pressed(switches[i]));
    }
    if (printer_.door.present()) tell(printer_.door.input, door_is_open());
}

}  // namespace pliant::twin
