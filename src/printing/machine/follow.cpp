#include "printing/machine/follow.hpp"

#include "printing/machine/motion.hpp"

namespace pliant::machine {
namespace {

Status follow_move(Followed& at, const Printer& printer, const Command& command) {
    const auto target = move_target(printer, command, at.lock.position());
    if (!target) return tl::unexpected(target.error());
    const Position from = at.lock.position();
    if (Status status = at.lock.move(*target); !status) return status;
    if (const auto feed = command.value('F'); feed && *feed > 0) at.feed_mm_s = *feed / 60;
    at.seconds += move_seconds(printer, from, *target, at.feed_mm_s);
    return {};
}

/// G28, or G92 for an axis that a person places at its home position.
Status follow_home(Followed& at, const Printer& printer, const Command& command) {
    std::vector<Axis> axes;
    for (const Word& word : command.words) {
        const auto axis = axis_of_letter(printer, word.letter);
        if (!axis) return input_error("{} is not an axis of {}", word.letter, printer.name);
        axes.push_back(*axis);
    }
    if (axes.empty()) axes = homing_order(printer);
    for (const Axis axis : axes) {
        if (command.is('G', 92) && !printer.axis(axis).homes_by_hand)
            return input_error("G92 moves the origin of {}: coordinates are absolute", printer.axis(axis).letter);
        // An axis that is not homed may be anywhere: count the whole travel, as the plan does.
        const AxisSpec& spec = printer.axis(axis);
        const int far_um = spec.homes_to_max ? spec.min_um : spec.max_um;
        at.seconds += home_seconds(printer, axis, at.lock.homed(axis) ? at.lock.position()[axis] : far_um);
        if (Status status = at.lock.home(axis); !status) return status;
    }
    return {};
}

}  // namespace

Status Followed::command(const Printer& printer, const Command& c) {
    if (c.is('G', 0) || c.is('G', 1)) return follow_move(*this, printer, c);
    if (c.is('G', 28) || c.is('G', 92)) return follow_home(*this, printer, c);
    if (c.is('G', 91)) return input_error("G91: relative moves do not survive a repeated line");
    if (c.is('G', 4)) seconds += c.value('P').value_or(0) / 1000 + c.value('S').value_or(0);
    if ((c.is('M', 84) || c.is('M', 18)) && !c.has('S')) lock.stopped_at(lock.position());
    if (moves_emergency_line(printer, c))
        return input_error("M42 P{}: that pin is the emergency line", printer.emergency_line.pin);
    return lock.output(c);
}

Status Followed::line(const Printer& printer, std::string_view line) {
    const auto parsed = parse_command(line);
    return parsed ? command(printer, *parsed) : tl::unexpected(parsed.error());
}

}  // namespace pliant::machine
