// The tables of a printer file about inputs and outputs of the board: pump, fans, limit switches, door, emergency line.
#include <string>
#include <utility>
#include <vector>

#include "printing/machine/gcode.hpp"
#include "printing/machine/printer_reading.hpp"
#include "printing/machine/switches.hpp"

namespace pliant::machine::reading {
namespace {

/// [[fan]], one table each; [fans] is the older form of a single one.
void read_fans(Reader& root, Printer& p) {
    if (root.has("fans") && root.has("fan")) root.problem("fans", "is the older form of [[fan]]; keep one of them");
    const Switch single = read_switch(root.table("fans", false));
    if (!single.on.empty()) p.fans.push_back(single);
    if (!root.has("fan")) return;
    for (Reader& r : root.tables("fan")) {
        Switch fan = read_switch(r);
        const auto same = [&](const Switch& other) { return same_output(other, fan); };
        if (fan.on.empty())
            root.problem("fan", "needs \"on\" and \"off\"");
        else if (std::any_of(p.fans.begin(), p.fans.end(), same) || same(p.pump))
            root.problem("fan", fmt::format("\"{}\" is the output of another fan or of the pump", fan.on));
        else
            p.fans.push_back(std::move(fan));
    }
}

LimitSwitch read_limit_switch(Reader& r, const Printer& p) {
    const bool wall = p.store() == Store::wall;
    const std::string axis = wall ? r.choice("axis", {"carriage", "platform", "lift", "rail"})
                                  : r.choice("axis", {"carriage", "platform", "tower", "table"});
    LimitSwitch s;
    for (const Axis a : all_axes) {
        if (axis_name(a, p.store()) == axis) s.axis = a;
    }
    s.at_max = r.choice("end", {"min", "max"}) == "max";
    s.inverted = r.boolean("inverted", false);
    if (r.has("axis") && !p.axis(s.axis).present()) r.problem("axis", fmt::format("the machine has no {}", axis));
    for (const LimitSwitch& other : p.limit_switches) {
        if (other.axis == s.axis && other.at_max == s.at_max) r.problem("end", "stands twice for this axis");
    }
    r.finish();
    return s;
}

void read_limit_switches(Reader& root, Printer& p) {
    if (!root.has("limit_switch")) return;
    for (Reader& r : root.tables("limit_switch")) p.limit_switches.push_back(read_limit_switch(r, p));
}

DoorSwitch read_door(Reader r, const Printer& p) {
    DoorSwitch door;
    door.input = r.choice("input", {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max", "z_probe", "filament"});
    door.inverted = r.boolean("inverted", false);
    for (const LimitSwitch& s : switches_of(p)) {
        const auto names = switch_names(p, s);
        if (std::find(names.begin(), names.end(), door.input) != names.end())
            r.problem("input",
                      fmt::format("{} is the limit switch of the {}", door.input, axis_name(s.axis, p.store())));
    }
    r.finish();
    return door;
}

EmergencyLine read_emergency_line(Reader r) {
    using Signal = EmergencyLine::Signal;
    constexpr int last_pin = 69;  // of a Mega 2560
    EmergencyLine line;
    const std::string signal = r.choice("signal", {"controller", "dtr", "rts", "file"});
    for (const Signal s : {Signal::controller, Signal::dtr, Signal::rts, Signal::file}) {
        if (signal_name(s) == signal) line.signal = s;
    }
    if (line.signal == Signal::controller) {
        line.pin = r.whole("pin", 0, last_pin);
    } else {
        line.device = r.text("device");
        if (r.has("device") && line.device.empty()) r.problem("device", "must name a serial port or a file");
    }
    if (line.signal == Signal::file) line.stop_high = r.choice("stop", {"high", "low"}, "high") == "high";
    r.finish();
    return line;
}

/// A list of limit switches must be complete: an axis without the one that it homes to would hit its end.
void check_limit_switches(Reader& root, const Printer& p) {
    if (p.limit_switches.empty()) return;
    for (const Axis axis : all_axes) {
        const AxisSpec& spec = p.axis(axis);
        if (!spec.present() || spec.homes_by_hand) continue;
        const bool listed = std::any_of(p.limit_switches.begin(), p.limit_switches.end(), [&](const LimitSwitch& s) {
            return s.axis == axis && s.at_max == spec.homes_to_max;
        });
        if (!listed)
            root.problem("limit_switch", fmt::format("the {} homes to a switch at its {} that is not listed",
                                                     axis_name(axis, p.store()), spec.homes_to_max ? "max" : "min"));
    }
}

/// If a magnet or fork shared its output with another device, switching that would release a vat.
void check_outputs(Reader& root, const Printer& p) {
    struct Named {
        std::string key;
        const Switch* device;
    };
    std::vector<Named> all = {{"pump", &p.pump}, {"wall.fork", &p.wall.fork}, {"hooks", &p.hooks.magnet.coil}};
    for (const Switch& fan : p.fans) all.insert(all.begin(), {"fan", &fan});
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].key != "hooks" && all[i].key != "wall.fork") continue;
        for (std::size_t k = 0; k < i; ++k) {
            if (same_output(*all[i].device, *all[k].device))
                root.problem(all[i].key, fmt::format("\"{}\" is the output of {}", all[i].device->on, all[k].key));
        }
        const auto on = parse_command(all[i].device->on);
        if (on && moves_emergency_line(p, *on))
            root.problem(all[i].key, fmt::format("\"{}\" is the pin of the emergency line", all[i].device->on));
    }
}

}  // namespace

void check_switch_commands(Reader& r, const Switch& s) {
    for (const auto& [key, text] : {std::pair{"on", s.on}, std::pair{"off", s.off}}) {
        if (text.empty()) continue;
        const auto command = parse_command(text);
        const bool switches = command && command->letter == 'M' &&
                              (command->number == 106 || command->number == 107 || command->number == 42);
        if (!switches) r.problem(key, "must be an M106, M107 or M42 command such as \"M106 P1 S255\"");
    }
    if (s.on.empty() != s.off.empty()) r.problem("on", "and \"off\" go together");
    const auto on = parse_command(s.on), off = parse_command(s.off);
    if (on && off && switched(s, *on) && switched(s, *off).value_or(true))
        r.problem("off", fmt::format("\"{}\" does not switch off what \"{}\" switches on", s.off, s.on));
}

Switch read_switch(Reader r) {
    Switch s{r.text("on", ""), r.text("off", "")};
    check_switch_commands(r, s);
    r.finish();
    return s;
}

void read_switches(Reader& root, Printer& p) {
    p.pump = read_switch(root.table("pump", false));
    read_fans(root, p);
    read_limit_switches(root, p);
    if (root.has("door")) p.door = read_door(root.table("door"), p);
    if (root.has("emergency_line")) p.emergency_line = read_emergency_line(root.table("emergency_line"));
}

void check_switches(Reader& root, const Printer& p) {
    check_limit_switches(root, p);
    check_outputs(root, p);
}

}  // namespace pliant::machine::reading
