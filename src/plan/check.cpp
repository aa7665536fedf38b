#include "plan/check.hpp"

#include <algorithm>

#include "machine/gcode.hpp"
#include "machine/interlock.hpp"

namespace pliant::plan {
namespace {

using machine::Command;

/// The machine as far as the text has been read.
struct Reading {
    const machine::Printer& printer;
    machine::Interlock interlock;
    bool absolute = false;
    bool moving = false;  ///< a move may still be under way: no fence since
};

Status run_move(Reading& r, const Command& command) {
    if (!r.absolute) return input_error("a move before G90");
    const auto target = machine::move_target(r.printer, command, r.interlock.position());
    if (!target) return tl::unexpected(target.error());
    r.moving = true;
    return r.interlock.move(*target);
}

Status run_home(Reading& r, const Command& command) {
    if (command.words.empty()) return input_error("G28 without axes homes in an order of its own");
    for (const machine::Word& word : command.words) {
        const auto axis = machine::axis_of_letter(r.printer, word.letter);
        if (!axis) return input_error("{} is not an axis", word.letter);
        if (Status status = r.interlock.home(*axis); !status) return status;
    }
    r.moving = false;
    return {};
}

Status run_command(Reading& r, std::string_view line) {
    if (line.size() > machine::max_line_chars) return input_error("longer than {} characters", machine::max_line_chars);
    const auto command = machine::parse_command(line);
    if (!command) return tl::unexpected(command.error());
    if (command->is('G', 0) || command->is('G', 1)) return run_move(r, *command);
    if (command->is('G', 28)) return run_home(r, *command);
    if (command->is('G', 90)) r.absolute = true;
    if (command->is('M', 400) || command->is('G', 4)) r.moving = false;
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
    if (Status status = r.interlock.light_on(r.moving); !status) return status;
    r.interlock.light_off();
    return {};
}

}  // namespace

Status check_gcode(std::string_view gcode, const machine::Printer& printer) {
    Reading reading{printer, machine::Interlock(printer), false, false};
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
