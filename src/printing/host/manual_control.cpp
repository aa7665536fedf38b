// Control by hand: moves, homing, vats, cleaning and light while no print is running.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "printing/host/control_private.hpp"
#include "printing/machine/gcode.hpp"

namespace pliant::host {
namespace {

using machine::Axis;

constexpr double slowest_feed_mm_s = 0.01;  // of moves by hand; G-code has a tenth of a mm/min

}  // namespace

/// From any thread: sends M410 to the current manual move. False if there is none, or the firmware would not act on it.
bool Control::Private::stop_move() {
    const std::scoped_lock lock(mutex);
    if (!moves_by_hand || stopped_by_hand || !hears_m112 || !wire) return false;
    stopped_by_hand = true;
    return wire->write("\nM410\n").has_value();
}

Status Control::Private::run_one_move(const std::string& program) {
    {
        const std::scoped_lock lock(mutex);
        moves_by_hand = true;
    }
    const Status status = machine->run(program);
    bool stopped = false;
    {
        const std::scoped_lock lock(mutex);
        moves_by_hand = false;
        stopped = std::exchange(stopped_by_hand, false);
    }
    if (!status || !stopped) return status;
    if (Status asked = machine->stand_where_stopped(); !asked) return asked;
    return failure("the move was stopped on its way; home the axes before the next one");
}

/// Runs the program that `program` makes for the present state; no print may be running or waiting to be resumed.
Status Control::Private::by_hand(std::function<Result<std::string>(const machine::Interlock&)> program, bool one_move) {
    return ask_for(
        State::working,
        [](const Snapshot& s) -> Status {
            if (s.can_resume) return failure("an interrupted print waits: resume it or cancel it first");
            return only_when({State::idle})(s);
        },
        [this, one_move, program = std::move(program)] {
            if (!machine) return desk.state(State::offline);
            const auto text = program(machine->state());
            forget_line();
            Status status =
                text ? (one_move ? run_one_move(*text) : machine->run(*text)) : tl::unexpected(text.error());
            show_machine();
            if (status || (!machine->link().was_reset() && !machine->link().wire_failed() && !desk.stopped())) {
                if (!status) desk.event("error", status.error().message);
                desk.state(State::idle, status ? "" : status.error().message);
            } else {
                fail(status.error());
            }
        });
}

Status Control::move_to(Axis axis, int um, double feed_mm_s) {
    if (!(feed_mm_s == 0 || feed_mm_s >= slowest_feed_mm_s))
        return input_error("a speed of {:g} mm/s: the slowest is {:g} mm/s", feed_mm_s, slowest_feed_mm_s);
    if (state_->stop_move()) return failure("the move under way is stopped instead; home the axes before the next one");
    const auto program = [this, axis, um, feed_mm_s](const machine::Interlock& at) -> Result<std::string> {
        machine::Position to = at.position();
        to[axis] = um;
        const machine::Printer& printer = state_->setup.printer;
        const double feed =
            feed_mm_s > 0 ? std::min(feed_mm_s, printer.axis(axis).speed_mm_s) : printer.axis(axis).speed_mm_s;
        return "G90\n" + machine::write_move(printer, at.position(), to, feed) + "\n";
    };
    return state_->by_hand(program, true);
}

Status Control::jog(Axis axis, int um, double feed_mm_s) {
    return move_to(axis, snapshot().position[axis] + um, feed_mm_s);
}

Status Control::home(std::vector<Axis> axes) {
    if (axes.empty()) axes = machine::homing_order(state_->setup.printer);
    return state_->by_hand([this, axes](const machine::Interlock&) -> Result<std::string> {
        std::string text;
        for (const std::string& line : machine::preamble(state_->setup.printer)) text += line + "\n";
        for (const Axis axis : axes) {
            if (!state_->setup.printer.axis(axis).present())
                return input_error("the printer has no {}", machine::axis_name(axis));
            text += machine::write_home(state_->setup.printer, axis) + "\n";
        }
        return text;
    });
}

Status Control::bring_vat(int slot) {
    return state_->by_hand(
        [this, slot](const machine::Interlock& at) { return state_->setup.programs.bring_vat(at, slot); });
}

Status Control::clean(double seconds) {
    return state_->by_hand(
        [this, seconds](const machine::Interlock& at) { return state_->setup.programs.clean(at, seconds); });
}

Status Control::prime(double seconds) {
    return clean(seconds);
}

}  // namespace pliant::host
