#include "printing/plan/check.hpp"

#include <algorithm>
#include <limits>

#include "printing/machine/gcode.hpp"
#include "printing/machine/motion.hpp"
#include "printing/machine/settling.hpp"

namespace pliant::plan {
namespace {

using machine::Command;

/// The machine's state after the lines read so far.
struct Reading {
    const machine::Printer& printer;
    machine::Interlock interlock;
    bool absolute = false;
    bool moving = false;  ///< no fence since the last move
    double feed_mm_s = 0;
    double clock_s = 0;
    double pump_since_s = 0;
    const Watch& watch;
    machine::Settling settling;
    int line = 0;
};

/// Reports the line's effect to the watch, given position `from` and time `clock_s` before it.
Status tell(const Reading& r, const machine::Position& from, double clock_s, const Command* command,
            const machine::Directive* directive) {
    if (!r.watch) return {};
    const bool travels = command != nullptr && (command->is('G', 0) || command->is('G', 1));
    return r.watch({r.line, command, directive, from, r.interlock.position(), travels ? r.feed_mm_s : 0,
                    r.clock_s - clock_s, &r.interlock});
}

/// Checks the pump's continuous run; called after every command that takes time.
Status check_pump_time(const Reading& r) {
    if (!r.interlock.pump_runs() || r.clock_s - r.pump_since_s <= r.printer.limits.cleaning_s) return {};
    return input_error("the pump runs for over {:g} s, the limit of {}", r.printer.limits.cleaning_s, r.printer.name);
}

Status run_move(Reading& r, const Command& command) {
    if (!r.absolute) return input_error("a move before G90");
    const auto target = machine::move_target(r.printer, command, r.interlock.position());
    if (!target) return tl::unexpected(target.error());
    if (const auto feed = command.value('F'); feed && *feed > 0) r.feed_mm_s = *feed / 60;
    r.moving = true;
    if (Status status = r.settling.check(r.interlock.position(), *target, r.clock_s); !status) return status;
    r.clock_s += machine::move_seconds(r.printer, r.interlock.position(), *target, r.feed_mm_s);
    if (Status status = r.interlock.move(*target); !status) return status;
    return check_pump_time(r);
}

Status run_home(Reading& r, const Command& command) {
    if (command.words.empty()) return input_error("G28 without axes homes in an order of its own");
    for (const machine::Word& word : command.words) {
        const auto axis = machine::axis_of_letter(r.printer, word.letter);
        if (!axis) return input_error("{} is not an axis of {}", word.letter, r.printer.name);
        if (Status status = r.interlock.home(*axis); !status) return status;
    }
    r.moving = false;
    return {};
}

/// G92 replaces homing, only for an axis that a person places at its home position.
Status run_set(Reading& r, const Command& command) {
    for (const machine::Word& word : command.words) {
        const auto axis = machine::axis_of_letter(r.printer, word.letter);
        const bool by_hand = axis && r.printer.axis(*axis).homes_by_hand &&
                             word.value.value_or(0) * 1000 == r.printer.axis(*axis).home_um();
        if (!by_hand) return input_error("G92 moves the origin of {}: coordinates are absolute", word.letter);
        if (Status status = r.interlock.home(*axis); !status) return status;
    }
    return {};
}

Status run_pump(Reading& r, bool on) {
    if (r.moving) return input_error("the pump is switched while the machine moves: M400 before it is missing");
    if (on && !r.interlock.pump_runs()) r.pump_since_s = r.clock_s;
    return r.interlock.pump(on);
}

bool latches(const machine::Printer& printer, const Command& command) {
    return machine::switched(printer.hooks.magnet.coil, command) || machine::switched(printer.wall.fork, command);
}

/// The magnet, or the fork of a retriever.
Status run_latch(Reading& r, const Command& command) {
    if (r.moving) return input_error("magnet or fork is switched while the machine moves: M400 before it is missing");
    r.settling.note(command, r.clock_s);
    return r.interlock.output(command);
}

/// Motors are disabled: the positions of the axes are unknown.
Status run_release(Reading& r, const Command& command) {
    if (command.has('S')) return {};
    r.interlock.stopped_at(r.interlock.position());
    return {};
}

/// Commands without effect on the machine: units, messages, reports, fences.
Status run_other(Reading& r, const Command& command) {
    if (command.is('M', 84) || command.is('M', 18)) return run_release(r, command);
    if (command.is('G', 91)) {
        return input_error("G91 does not belong here: a relative move that the wire repeats is made twice; write G90");
    }
    const bool classic = r.printer.controller.dialect == machine::Dialect::classic;
    if (classic && (command.is('M', 82) || command.is('M', 302))) return {};
    constexpr int known_g[] = {21, 90};
    constexpr int known_m[] = {17, 42, 73, 85, 105, 106, 107, 110, 113, 114, 115, 117, 118, 119, 400};
    const auto knows = [&](const auto& list) {
        return std::find(std::begin(list), std::end(list), command.number) != std::end(list);
    };
    const bool known = command.letter == 'G' ? knows(known_g) : knows(known_m);
    return known ? Status{} : input_error("{}{} is not a command that a job may hold", command.letter, command.number);
}

/// `N12 G1 X3*77` as on the wire: only the command.
std::string_view without_number(std::string_view line) {
    if (line.empty() || line.front() != 'N') return line;
    const std::size_t blank = line.find(' ');
    if (blank == std::string_view::npos) return line;
    return machine::strip_comment(line.substr(blank + 1, line.rfind('*') - blank - 1));
}

Status run_command(Reading& r, const Command& command) {
    if (command.is('G', 0) || command.is('G', 1)) return run_move(r, command);
    if (command.is('G', 28)) return run_home(r, command);
    if (command.is('G', 92)) return run_set(r, command);
    if (machine::moves_emergency_line(r.printer, command))
        return input_error("M42 P{}: that pin is the emergency line", r.printer.emergency_line.pin);
    if (const auto pump = machine::switched(r.printer.pump, command)) return run_pump(r, *pump);
    if (latches(r.printer, command)) return run_latch(r, command);
    if (command.is('G', 90)) r.absolute = true;
    if (command.is('M', 400) || command.is('G', 4)) r.moving = false;
    if (command.is('G', 4)) {
        r.clock_s += command.value('P').value_or(0) / 1000 + command.value('S').value_or(0);
        return check_pump_time(r);
    }
    return run_other(r, command);
}

Status run_text(Reading& r, std::string_view line) {
    if (line.size() > machine::max_line_chars) return input_error("longer than {} characters", machine::max_line_chars);
    const auto command = machine::parse_command(line);
    if (!command) return tl::unexpected(command.error());
    const machine::Position from = r.interlock.position();
    const double clock_s = r.clock_s;
    if (Status status = run_command(r, *command); !status) return status;
    return tell(r, from, clock_s, &*command, nullptr);
}

Status run_expose(Reading& r, const machine::Expose& expose) {
    if (expose.seconds > r.printer.limits.exposure_s) {
        return input_error("exposure of {:g} s, the limit of {} is {:g} s", expose.seconds, r.printer.name,
                           r.printer.limits.exposure_s);
    }
    if (Status status = r.interlock.light_on(r.moving); !status) return status;
    r.interlock.light_off();
    return {};
}

Status run_directive(Reading& r, std::string_view line) {
    const auto directive = machine::parse_directive(line);
    if (!directive) return tl::unexpected(directive.error());
    if (directive->expose) {
        if (Status status = run_expose(r, *directive->expose); !status) return status;
    }
    return tell(r, r.interlock.position(), r.clock_s, nullptr, &*directive);
}

}  // namespace

Result<machine::Interlock> replay_gcode(std::string_view gcode, const machine::Printer& printer, int lines,
                                        const Watch& watch) {
    Reading reading{printer, machine::Interlock(printer), false, false, 0, 0, 0, watch, machine::Settling(printer)};
    for (int number = 1; number <= lines && !gcode.empty(); ++number) {
        const std::string_view raw = gcode.substr(0, gcode.find('\n'));
        gcode.remove_prefix(std::min(gcode.size(), raw.size() + 1));
        const std::string_view line = without_number(machine::strip_comment(raw));
        Status status;
        reading.line = number;
        if (machine::is_directive(raw))
            status = run_directive(reading, raw);
        else if (!line.empty())
            status = run_text(reading, line);
        if (!status)
            return tl::unexpected(
                Error{status.error().cause, fmt::format("G-code line {}: {}", number, status.error().message)});
    }
    return std::move(reading.interlock);
}

Status check_gcode(std::string_view gcode, const machine::Printer& printer) {
    const auto end = replay_gcode(gcode, printer, std::numeric_limits<int>::max());
    return end ? Status{} : tl::unexpected(end.error());
}

}  // namespace pliant::plan
