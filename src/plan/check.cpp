#include "plan/check.hpp"

#include <algorithm>

#include "machine/gcode.hpp"
#include "machine/interlock.hpp"
#include "machine/motion.hpp"

namespace pliant::plan {
namespace {

using machine::Command;

/// The machine as far as the text has been read.
struct Reading {
    const machine::Printer& printer;
    machine::Interlock interlock;
    bool absolute = false;
    bool moving = false;  ///< a move may still be under way: no fence since
    double feed_mm_s = 0;
    double clock_s = 0;
    double pump_since_s = 0;
};

/// The pump's longest stretch, looked at after every command that takes time.
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

/// G92 stands for homing, and only for an axis that a person stands at its home.
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

Status run_command(Reading& r, std::string_view line) {
    if (line.size() > machine::max_line_chars) return input_error("longer than {} characters", machine::max_line_chars);
    const auto command = machine::parse_command(line);
    if (!command) return tl::unexpected(command.error());
    if (command->is('G', 0) || command->is('G', 1)) return run_move(r, *command);
    if (command->is('G', 28)) return run_home(r, *command);
    if (command->is('G', 92)) return run_set(r, *command);
    if (const auto pump = machine::switched(r.printer.pump, *command)) return run_pump(r, *pump);
    if (command->is('G', 90)) r.absolute = true;
    if (command->is('M', 400) || command->is('G', 4)) r.moving = false;
    if (command->is('G', 4)) {
        r.clock_s += command->value('P').value_or(0) / 1000 + command->value('S').value_or(0);
        return check_pump_time(r);
    }
    const bool classic = r.printer.controller.dialect == machine::Dialect::classic;
    if (classic && (command->is('M', 82) || command->is('M', 302))) return {};
    constexpr int known_m[] = {42, 84, 106, 107, 118, 400};
    const bool known = command->letter == 'G'
                           ? command->number == 4 || command->number == 90
                           : std::find(std::begin(known_m), std::end(known_m), command->number) != std::end(known_m);
    return known ? Status{} : input_error("{}{} does not belong to the dialect", command->letter, command->number);
}

Status run_directive(Reading& r, std::string_view line) {
    const auto directive = machine::parse_directive(line);
    if (!directive) return tl::unexpected(directive.error());
    if (!directive->expose) return {};
    if (directive->expose->seconds > r.printer.limits.exposure_s) {
        return input_error("{:g} s of light, the limit of {} is {:g} s", directive->expose->seconds, r.printer.name,
                           r.printer.limits.exposure_s);
    }
    if (Status status = r.interlock.light_on(r.moving); !status) return status;
    r.interlock.light_off();
    return {};
}

}  // namespace

Status check_gcode(std::string_view gcode, const machine::Printer& printer) {
    Reading reading{printer, machine::Interlock(printer), false, false, 0, 0, 0};
    int number = 0;
    while (!gcode.empty()) {
        const std::string_view raw = gcode.substr(0, gcode.find('\n'));
        gcode.remove_prefix(std::min(gcode.size(), raw.size() + 1));
        ++number;
        const std::string_view line = machine::strip_comment(raw);
        Status status;
        if (machine::is_directive(raw))
            status = run_directive(reading, raw);
        else if (!line.empty())
            status = run_command(reading, line);
        if (!status)
            return tl::unexpected(
                Error{status.error().cause, fmt::format("G-code line {}: {}", number, status.error().message)});
    }
    return {};
}

}  // namespace pliant::plan
