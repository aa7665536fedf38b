#include "printing/machine/switches.hpp"

#include <algorithm>
#include <cstdlib>

#include "printing/machine/marlin_axes.hpp"

namespace pliant::machine {
namespace {

std::string_view end_name(const LimitSwitch& s) {
    return s.at_max ? "max" : "min";
}

int end_um(const Printer& printer, const LimitSwitch& s) {
    return s.at_max ? printer.axis(s.axis).max_um : printer.axis(s.axis).min_um;
}

std::optional<bool> reading_of(const std::vector<std::string>& names, const std::vector<SwitchReading>& readings) {
    for (const SwitchReading& r : readings) {
        if (std::find(names.begin(), names.end(), r.name) != names.end()) return r.pressed;
    }
    return std::nullopt;
}

Status check_pressed(const Printer& printer, const Interlock& state, const LimitSwitch& s) {
    if (!state.homed(s.axis)) return {};
    const int at_um = state.position()[s.axis];
    if (std::abs(at_um - end_um(printer, s)) <= switch_reach_um) return {};
    return failure(
        "the {} limit switch of the {} is pressed, but the {} stands at {:.3f} "
        "mm: the switch is stuck, its wire is off, or \"inverted\" is wrong",
        end_name(s), axis_name(s.axis), axis_name(s.axis), at_um / 1000.0);
}

/// Both ends cannot be pressed at once.
Status check_both(const Printer& printer, const std::vector<LimitSwitch>& pressed) {
    for (const LimitSwitch& low : pressed) {
        for (const LimitSwitch& high : pressed) {
            if (low.axis != high.axis || low.at_max || !high.at_max) continue;
            return failure(
                "both limit switches of the {} are pressed: one of {} and "
                "{} is stuck, its wire is off, or \"inverted\" is wrong",
                axis_name(low.axis), switch_names(printer, low).front(), switch_names(printer, high).front());
        }
    }
    return {};
}

}  // namespace

std::vector<LimitSwitch> switches_of(const Printer& printer) {
    if (!printer.limit_switches.empty()) return printer.limit_switches;
    std::vector<LimitSwitch> switches;
    for (const Axis axis : all_axes) {
        const AxisSpec& spec = printer.axis(axis);
        if (spec.present() && !spec.homes_by_hand) switches.push_back({axis, spec.homes_to_max, false});
    }
    return switches;
}

std::vector<std::string> switch_names(const Printer& printer, const LimitSwitch& which) {
    const AxisSpec& axis = printer.axis(which.axis);
    std::vector<std::string> names = {
        fmt::format("{}_{}", static_cast<char>(axis.letter - 'A' + 'a'), end_name(which))};
    if (const auto place = marlin_place(printer, axis); place && *place != axis.letter)
        names.push_back(fmt::format("{}_{}", static_cast<char>(*place - 'A' + 'a'), end_name(which)));
    return names;
}

std::optional<SwitchReading> parse_switch(std::string_view line) {
    constexpr std::size_t longest_name = 16;
    const std::size_t colon = line.find(": ");
    if (colon == 0 || colon == std::string_view::npos || colon > longest_name) return std::nullopt;
    const std::string_view name = line.substr(0, colon), word = line.substr(colon + 2);
    const bool plain = std::all_of(name.begin(), name.end(),
                                   [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; });
    if (!plain || (word != "TRIGGERED" && word != "open")) return std::nullopt;
    return SwitchReading{std::string(name), word == "TRIGGERED"};
}

std::optional<bool> door_open(const Printer& printer, const std::vector<SwitchReading>& readings) {
    return reading_of({printer.door.input}, readings);
}

Status check_switches(const Printer& printer, const Interlock& state, const std::vector<SwitchReading>& readings) {
    std::vector<LimitSwitch> pressed;
    for (const LimitSwitch& s : printer.limit_switches) {
        const auto reading = reading_of(switch_names(printer, s), readings);
        if (!reading)
            return failure(
                "M119 does not name {}, the {} limit switch of the {}: is this the firmware of this machine?",
                switch_names(printer, s).front(), end_name(s), axis_name(s.axis));
        if (!*reading) continue;
        pressed.push_back(s);
        if (Status status = check_pressed(printer, state, s); !status) return status;
    }
    if (Status status = check_both(printer, pressed); !status) return status;
    if (!printer.door.present()) return {};
    if (!door_open(printer, readings))
        return failure("M119 does not name {}, the switch of the door", printer.door.input);
    return {};
}

}  // namespace pliant::machine
