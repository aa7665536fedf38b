// What the virtual printer's commands do; the wire and the clock are in twin.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "twin/twin.hpp"

namespace pliant::twin {
namespace {

using machine::Axis;
using machine::Command;

/// Commands that are accepted and change nothing that the twin models.
bool is_quiet(const Command& c) {
    constexpr std::array<int, 8> numbers = {18, 82, 85, 108, 110, 113, 302, 410};
    return c.letter == 'M' && std::find(numbers.begin(), numbers.end(), c.number) != numbers.end();
}

double dwell_seconds(const Command& c) {
    if (const auto seconds = c.value('S')) return std::clamp(*seconds, 0.0, 86400.0);
    return std::clamp(c.value('P').value_or(0) / 1000, 0.0, 86400.0);
}

}  // namespace

std::vector<Axis> Twin::axes_to_home(const Command& command) const {
    std::vector<Axis> axes;
    for (const machine::Word& word : command.words) {
        if (const auto axis = machine::axis_of_letter(printer_, word.letter)) axes.push_back(*axis);
    }
    if (axes.empty()) axes = machine::homing_order(printer_);
    return axes;
}

/// When the command is done and its ok may be said.
double Twin::blocks_until(const Command& c) {
    const double still = std::max(now_s_, motors_.done_at());
    if (c.is('G', 0) || c.is('G', 1)) return motors_.room_at(now_s_);
    if (c.is('G', 4)) return still + dwell_seconds(c);
    if (c.is('M', 400)) return still;
    if (!c.is('G', 28)) return now_s_;
    double seconds = 0;
    for (const Axis axis : axes_to_home(c)) seconds += motors_.home_seconds(axis);
    return still + seconds;
}

void Twin::execute(const Command& c, const Queued& queued) {
    if (c.is('G', 0) || c.is('G', 1)) return execute_move(c);
    if (c.is('G', 28)) return execute_home(c);
    if (c.is('G', 92)) return execute_set(c);
    if (c.is('M', 106) || c.is('M', 107) || c.is('M', 42)) return execute_switch(c);
    if (c.is('G', 4) || c.is('G', 90) || c.is('M', 400) || is_quiet(c)) {
        // M110 in an unnumbered line sets the number here; a numbered one did so when it was verified.
        if (c.is('M', 110) && !queued.number) reader_.set_last_number(static_cast<long>(c.value('N').value_or(0)));
        return;
    }
    execute_other(c);
}

void Twin::execute_move(const Command& c) {
    // Motors that stood still for too long have been switched off, silently.
    if (idle_limit_s_ > 0 && now_s_ - motors_.done_at() > idle_limit_s_) motors_.release(now_s_);
    if (const auto feed = c.value('F'); feed && *feed > 0) feed_mm_s_ = *feed / 60;
    const auto target = machine::move_target(printer_, c, interlock().position());
    if (!target) return violation(target.error().message);
    if (*target == interlock().position()) return;
    if (Status status = motors_.move(now_s_, *target, feed_mm_s_); !status) return violation(status.error().message);
    note_vat();
}

void Twin::execute_home(const Command& c) {
    for (const Axis axis : axes_to_home(c)) {
        ++log_.homings;
        if (Status status = motors_.home(now_s_, axis); !status) violation(status.error().message);
    }
}

/// G92 stands for homing where a person has stood the axis at its home; anything else would move the origin.
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

/// Counts swaps, and those with too little cleaning between the last light and the new vat.
void Twin::note_vat() {
    const auto vat = interlock().hooked_vat();
    if (!vat || *vat == last_vat_) return;
    if (last_vat_ >= 0) {
        ++log_.swaps;
        // The rise of the hooks, during which the pump still runs, is only queued here.
        const double sprayed = sprayed_s_ + (pump_on_ ? std::max(now_s_, motors_.done_at()) - pump_since_s_ : 0);
        if (!printer_.pump.on.empty() && sprayed < 0.99 * printer_.cleaning.spray_s) ++log_.short_cleanings;
    }
    last_vat_ = *vat;
}

void Twin::execute_switch(const Command& c) {
    const auto on = machine::switched(printer_.pump, c);
    if (!on || *on == pump_on_) return;
    if (Status status = motors_.interlock().pump(*on); !status) return violation(status.error().message);
    pump_on_ = *on;
    if (pump_on_)
        pump_since_s_ = now_s_;
    else
        sprayed_s_ += now_s_ - pump_since_s_;
}

void Twin::execute_other(const Command& c) {
    if (c.is('M', 84)) {
        if (const auto limit = c.value('S'))
            idle_limit_s_ = *limit;
        else
            motors_.release(now_s_);
    } else if (c.is('M', 114)) {
        std::string line;
        for (const Axis axis : machine::all_axes) {
            if (!printer_.axis(axis).present()) continue;
            line += fmt::format("{}:{:.3f} ", printer_.axis(axis).letter, interlock().position()[axis] / 1000.0);
        }
        say(line);
    } else if (c.is('M', 115)) {
        say("FIRMWARE_NAME:Pliant twin, Marlin dialect PROTOCOL_VERSION:1.0 MACHINE_TYPE:" + printer_.name);
        say("Cap:EMERGENCY_PARSER:1");
    } else if (c.is('M', 118)) {
        say(fmt::format("{}{}", c.value('E') == 1 ? "echo:" : (c.value('A') == 1 ? "//" : ""), c.text));
    } else if (c.is('M', 112)) {
        kill();
    } else {
        say(fmt::format("echo:Unknown command: \"{}{}\"", c.letter, c.number));
    }
}

}  // namespace pliant::twin
