#include "printing/machine/firmware.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "printing/machine/decimal.hpp"
#include "printing/machine/gcode.hpp"
#include "printing/machine/marlin_axes.hpp"
#include "printing/machine/switches.hpp"

namespace pliant::machine {
namespace {

constexpr int ramps_outputs = 5;
constexpr double most_steps_s = 40000;  // maximum of an 8-bit board at 16 MHz

/// One of Marlin's axes, in Marlin's order. An extra axis needs all those before it; one that the machine does not have
/// becomes a stand-in that never moves.
struct Slot {
    char id = 'X';  ///< X Y Z, then I J K
    const AxisSpec* axis = nullptr;

    [[nodiscard]] bool extra() const { return id >= 'I' && id <= 'K'; }
};

/// A motor socket of the board, with its pins.
struct Socket {
    std::string_view name;
    int step, dir, enable;
};
constexpr std::array<Socket, 2> free_sockets = {Socket{"E0", 26, 28, 24}, Socket{"E1", 36, 34, 30}};

/// 2.1.3 defines a switch by its level when pressed, and finds out by itself which switches home an axis.
bool finds_plugs(const Printer& printer) {
    return printer.controller.firmware >= MarlinRelease::v2_1_3;
}

/// X, Y and Z in any case, then the machine's extra axes.
Result<std::vector<Slot>> marlin_axes(const Printer& printer) {
    std::vector<Slot> slots = {{'X', nullptr}, {'Y', nullptr}, {'Z', nullptr}};
    for (const AxisSpec& axis : printer.axes) {
        if (!axis.present()) continue;
        const std::size_t at = marlin_letters.find(axis.letter);
        if (at == std::string_view::npos)
            return input_error("letter {}: Marlin 2.1 has no such axis; the list is for dialect = \"marlin\"",
                               axis.letter);
        if (at < 3) slots[at].axis = &axis;
    }
    const std::vector<const AxisSpec*> extra = extra_axes(printer);
    for (std::size_t i = 0; i < extra.size(); ++i) {
        if (i == marlin_extra_places.size())
            return input_error("letter {}: a fourth axis beyond X Y Z is more than this list knows", extra[i]->letter);
        slots.push_back({marlin_extra_places[i], extra[i]});
    }
    return slots;
}

Status check_drives(const Printer& printer) {
    int motors = 0;
    for (const Axis a : all_axes) {
        const AxisSpec& axis = printer.axis(a);
        if (!axis.present()) continue;
        motors += axis.drive.motors;
        if (axis.drive.motors > 1 && axis.letter != 'Z')
            return input_error("axis.{}.motors: only Z may have two here", axis_name(a, printer.store()));
        if (!axis.drive.known())
            return input_error("axis.{}: steps are not known; give per_turn, microsteps and gear",
                               axis_name(a, printer.store()));
        const double steps_s = axis.speed_mm_s * axis.drive.steps_per_mm();
        if (steps_s > most_steps_s) {
            return input_error(
                "axis.{}: {:.0f} steps a second at full speed; an 8-bit board makes {:.0f}: fewer microsteps",
                axis_name(a, printer.store()), steps_s, most_steps_s);
        }
    }
    if (motors > ramps_outputs) return input_error("{} motors: RAMPS 1.4 has {} outputs", motors, ramps_outputs);
    return {};
}

class List {
public:
    void add(std::string name, std::string value, std::string reason = "") {
        settings_.push_back({std::move(name), std::move(value), std::move(reason)});
    }
    [[nodiscard]] const std::vector<FirmwareSetting>& settings() const { return settings_; }
    std::vector<FirmwareSetting> take() { return std::move(settings_); }

private:
    std::vector<FirmwareSetting> settings_;
};

/// M106 P2: the output for a hotend heater is free when there is no hotend.
void add_third_output(List& list, const Printer& printer) {
    std::vector<Switch> devices = printer.fans;
    devices.push_back(printer.pump);
    for (const Switch& device : devices) {
        const auto command = parse_command(device.on);
        if (command && command->is('M', 106) && command->value('P') == 2.0)
            return list.add("FAN2_PIN", "10", fmt::format("{}: D10, free without an extruder", device.on));
    }
}

/// M42 can write to a pin only if the firmware is built with it.
void add_pin_control(List& list, const Printer& printer) {
    std::vector<Switch> devices = printer.fans;
    devices.insert(devices.end(), {printer.pump, printer.hooks.magnet.coil, printer.wall.fork});
    for (const Switch& device : devices) {
        const auto command = parse_command(device.on);
        if (command && command->is('M', 42))
            return list.add("DIRECT_PIN_CONTROL", "on", fmt::format("{}: M42 switches that pin", device.on));
    }
}

/// The relay released by M112: in Marlin's terms the switch of a power supply.
void add_emergency_line(List& list, const Printer& printer) {
    if (printer.emergency_line.signal != EmergencyLine::Signal::controller) return;
    list.add("PSU_CONTROL", "on", "the emergency line: a relay that holds the power of motors, pump, fans and lamp");
    list.add("PS_ON_PIN", std::to_string(printer.emergency_line.pin), "as emergency_line.pin");
    list.add("PSU_ACTIVE_STATE", "HIGH", "the relay is held while all is well, and falls when M112 kills the firmware");
    list.add("PSU_DEFAULT_OFF", "off", "power as soon as the firmware runs; no program may send M80 or M81");
}

/// A C string. Characters with a meaning in C or to the parser of config.ini, such as \", % and #, become '_'.
std::string c_string(std::string_view name) {
    constexpr std::string_view harmless = " -_.,:()+/";
    std::string text;
    for (const char c : name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                           harmless.find(c) != std::string_view::npos;
        text += plain ? c : '_';
    }
    return "\"" + text + "\"";
}

void add_board(List& list, const Printer& printer) {
    list.add("MOTHERBOARD", "BOARD_RAMPS_14_EFF",
             "RAMPS 1.4 whose outputs D9 and D8 are fans: M106 P0 switches the fans on D9, M106 P1 the pump on D8");
    add_third_output(list, printer);
    list.add("SERIAL_PORT", "0", "the USB socket of the Mega 2560");
    list.add("BAUDRATE", std::to_string(printer.controller.baud_rate), "as controller.baud_rate");
    list.add("CUSTOM_MACHINE_NAME", c_string(printer.name), "what M115 answers as MACHINE_TYPE");
    list.add("EXTRUDERS", "0",
             "resin: nothing to heat or to push; without an extruder no heater output can ever be on");
    list.add("TEMP_SENSOR_0", "0", "no heater, so no sensor and no thermal protection that could stop a print");
    list.add("TEMP_SENSOR_BED", "0");
    list.add("SDSUPPORT", "off", "the host sends every line; a card would only offer a second way to start");
    list.add("EEPROM_SETTINGS", "off", "what is built is what runs: no stored value can differ from this list");
    list.add("USE_WATCHDOG", "on", "a firmware that hangs restarts, which the host sees and stops");
}

void add_wire(List& list, const Printer& printer) {
    list.add("EMERGENCY_PARSER", "on", "M112, M108 and M410 act as they arrive, not when the queue reaches them");
    list.add("HOST_KEEPALIVE_FEATURE", "on", "`busy` while a move or a wash takes long: silence then means a fault");
    list.add("DEFAULT_KEEPALIVE_INTERVAL", "2", "seconds; the host waits several of these before it doubts the board");
    list.add("HOST_ACTION_COMMANDS", "on", "the board can say that it halted");
    list.add("ADVANCED_OK", "on", "`ok N12 P15 B3`: the host knows which line was taken and what room is left");
    list.add("EXTENDED_CAPABILITIES_REPORT", "on", "M115 tells the host, and pliant check --firmware, what is there");
    list.add("BUFSIZE", std::to_string(printer.controller.window_lines), "as controller.window_lines");
    list.add("RX_BUFFER_SIZE", printer.controller.window_bytes < 128 ? "128" : "256",
             "more than controller.window_bytes, or lines that the host has under way are lost");
    list.add("BLOCK_BUFFER_SIZE", "16", "moves that are planned ahead");
}

void add_idle(List& list, MarlinRelease release) {
    list.add(release >= MarlinRelease::v2_1_3 ? "DEFAULT_STEPPER_TIMEOUT_SEC" : "DEFAULT_STEPPER_DEACTIVE_TIME", "0",
             "motors never let go: platform and tower would sink in a long wash or a pause, unnoticed");
    list.add("NO_MOTION_BEFORE_HOMING", "on", "soft limits hold on homed axes only: nothing moves before");
    list.add("MIN_SOFTWARE_ENDSTOPS", "on", "nothing leaves its travel, whatever is sent");
    list.add("MAX_SOFTWARE_ENDSTOPS", "on");
    list.add("SLOWDOWN", "off", "moves keep their speed when few are queued: times are as planned");
}

/// Settings without a default in Marlin for axes beyond X, Y and Z.
void add_extra_axis(List& list, const Slot& slot) {
    const int n = 4 + (slot.id - 'I');
    list.add(fmt::format("AXIS{}_NAME", n), fmt::format("'{}'", slot.axis->letter), "its letter in G-code");
    list.add(fmt::format("AXIS{}_ROTATES", n), slot.axis->rotary ? "on" : "off",
             slot.axis->rotary ? "it turns: degrees" : "it is linear: mm, which is not Marlin's default");
    list.add(fmt::format("{}_ENABLE_ON", slot.id), "0", "the level that switches its driver on: low");
    list.add(fmt::format("INVERT_{}_DIR", slot.id), "false", "true, or the motor's plug turned round, if it runs away");
}

void add_socket(List& list, std::string_view id, const Socket& socket) {
    list.add(fmt::format("{}_STEP_PIN", id), std::to_string(socket.step),
             fmt::format("socket {}, free without an extruder", socket.name));
    list.add(fmt::format("{}_DIR_PIN", id), std::to_string(socket.dir));
    list.add(fmt::format("{}_ENABLE_PIN", id), std::to_string(socket.enable));
}

Status add_motors(List& list, const std::vector<Slot>& slots) {
    auto socket = free_sockets.begin();
    for (const Slot& slot : slots) {
        list.add(fmt::format("{}_DRIVER_TYPE", slot.id), "A4988",
                 slot.axis == nullptr
                     ? "no axis of the machine: Marlin wants one before Z and the extra axes; nothing is plugged in"
                     : fmt::format("letter {}; or the name of the driver that is plugged in", slot.axis->letter));
        if (slot.extra()) add_extra_axis(list, slot);
        const bool second = slot.axis != nullptr && slot.axis->drive.motors > 1;
        if (second)
            list.add("Z2_DRIVER_TYPE", "A4988", "the second screw has a driver of its own, which steps with the first");
        if (!slot.extra() && !second) continue;
        if (socket == free_sockets.end())
            return input_error(
                "letter {}: RAMPS 1.4 has no free socket for its motor: Marlin keeps those of X, Y and Z",
                slot.axis->letter);
        add_socket(list, slot.extra() ? std::string_view(&slot.id, 1) : "Z2", *socket++);
    }
    return {};
}

/// A switch input of the board by its name in M119, and its pin.
struct Input {
    std::string_view name;
    int pin;
};
constexpr std::array<Input, 2> free_inputs = {Input{"x_max", 2}, Input{"y_max", 15}};

/// Whether a limit switch or the door uses the input, so that no extra axis may.
bool is_taken(const Printer& printer, std::string_view input) {
    if (printer.door.input == input) return true;
    const auto switches = switches_of(printer);
    return std::any_of(switches.begin(), switches.end(),
                       [&](const LimitSwitch& s) { return switch_names(printer, s).front() == input; });
}

/// A switch of an axis, and how Marlin is told of it.
struct Plug {
    char id;
    bool at_max, inverted;
    bool homes = true;  ///< false: at the other end of the axis, or the door's
};

void add_plug(List& list, const Printer& printer, const Plug& plug, const std::string& reason = "") {
    const std::string_view end = plug.at_max ? "MAX" : "MIN";
    const std::string open = plug.inverted ? "inverted = true: a normally open switch" : "";
    if (!finds_plugs(printer)) {
        list.add(fmt::format("USE_{}{}_PLUG", plug.id, end), "on", reason);
        list.add(fmt::format("{}_{}_ENDSTOP_INVERTING", plug.id, end), plug.inverted ? "true" : "false", open);
        return;
    }
    if (!plug.homes) list.add(fmt::format("{}_SAFETY_STOP", plug.id), "on", reason);
    list.add(fmt::format("{}_{}_ENDSTOP_HIT_STATE", plug.id, end), plug.inverted ? "LOW" : "HIGH", open);
}

/// The lower input of an axis that homes upwards must be ignored: nothing is connected there.
void add_no_plug(List& list, const Printer& printer, char id) {
    if (!finds_plugs(printer)) return list.add(fmt::format("USE_{}MIN_PLUG", id), "off");
    if (id == 'Z')
        list.add("Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN", "off", "no probe: the input Z_MIN is not to be looked at");
}

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return result;
}

std::string upper(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return result;
}

std::string low_end_of(const Slot& slot) {
    return lower(std::string_view(&slot.id, 1)) + "_min";
}

/// A stand-in is configured to home at that input, which includes the switch's settings.
bool is_home_of_stand_in(std::string_view input, const std::vector<Slot>& slots) {
    return std::any_of(slots.begin(), slots.end(),
                       [&](const Slot& s) { return s.axis == nullptr && low_end_of(s) == input; });
}

void add_door(List& list, const std::vector<Slot>& slots, const Printer& printer) {
    const DoorSwitch& door = printer.door;
    if (!door.present()) return;
    const std::string id = upper(door.input.substr(0, 1));
    if (is_home_of_stand_in(door.input, slots)) return;
    if (door.input.ends_with("_min") || door.input.ends_with("_max"))
        return add_plug(list, printer, {id[0], door.input.ends_with("_max"), door.inverted, false},
                        fmt::format("the door: M119 calls its switch {}", door.input));
    const std::string reason = fmt::format("the door is on the input {}: enable it as your board needs", door.input);
    if (door.input == "filament") return list.add("FIL_RUNOUT_STATE", door.inverted ? "LOW" : "HIGH", reason);
    if (finds_plugs(printer)) return list.add("Z_MIN_PROBE_ENDSTOP_HIT_STATE", door.inverted ? "LOW" : "HIGH", reason);
    list.add("Z_MIN_PROBE_ENDSTOP_INVERTING", door.inverted ? "true" : "false", reason);
}

bool has_far_switch(const Printer& printer, const AxisSpec& axis) {
    const auto switches = switches_of(printer);
    return std::any_of(switches.begin(), switches.end(), [&](const LimitSwitch& s) {
        return &printer.axis(s.axis) == &axis && s.at_max != axis.homes_to_max;
    });
}

/// The switches of an axis; for a stand-in the one where it would home.
void add_axis_switches(List& list, const Printer& printer, const Slot& slot) {
    const bool to_max = slot.axis != nullptr && slot.axis->homes_to_max;
    list.add(fmt::format("{}_HOME_DIR", slot.id), to_max ? "1" : "-1",
             slot.axis == nullptr ? "never homed" : fmt::format("home = \"{}\"", to_max ? "max" : "min"));
    Plug home{slot.id, to_max, false}, far{slot.id, !to_max, false, false};
    for (const LimitSwitch& s : switches_of(printer)) {
        if (&printer.axis(s.axis) == slot.axis) (s.at_max == to_max ? home : far).inverted = s.inverted;
    }
    const bool with_door = printer.door.input == low_end_of(slot);
    const bool door_only = slot.axis == nullptr && with_door;
    if (door_only) home.inverted = printer.door.inverted;
    add_plug(list, printer, home, door_only ? "the door is on this input" : "");
    if (slot.axis != nullptr && has_far_switch(printer, *slot.axis))
        return add_plug(list, printer, far, "the switch at the other end");
    if (to_max && !with_door) add_no_plug(list, printer, slot.id);
}

Status add_switches(List& list, const std::vector<Slot>& slots, const Printer& printer) {
    list.add("ENDSTOPPULLUPS", "on", "normally closed switches to ground: a broken wire reads as pressed, and stops");
    auto input = free_inputs.begin();
    for (const Slot& slot : slots) {
        add_axis_switches(list, printer, slot);
        if (!slot.extra()) continue;
        while (input != free_inputs.end() && is_taken(printer, input->name)) ++input;
        if (input == free_inputs.end() || has_far_switch(printer, *slot.axis))
            return input_error("letter {}: RAMPS 1.4 has no free input for its limit switch", slot.axis->letter);
        list.add(
            fmt::format("{}_{}_PIN", slot.id, slot.axis->homes_to_max ? "MAX" : "MIN"), std::to_string(input->pin),
            fmt::format("the input {}, which {} leaves free", upper(input->name), upper(input->name.substr(0, 1))));
        ++input;
    }
    add_door(list, slots, printer);
    list.add("VALIDATE_HOMING_ENDSTOPS", "on", "homing that ends without its switch is an error");
    return {};
}

void add_travel(List& list, const std::vector<Slot>& slots) {
    for (const Slot& slot : slots) {
        const int low_um = slot.axis == nullptr ? 0 : slot.axis->min_um;
        const int high_um = slot.axis == nullptr ? 1000 : slot.axis->max_um;
        if (slot.id == 'X' || slot.id == 'Y')
            list.add(fmt::format("{}_BED_SIZE", slot.id), decimal((high_um - low_um) / 1000.0), "its travel");
        list.add(fmt::format("{}_MIN_POS", slot.id), decimal(low_um / 1000.0),
                 slot.axis == nullptr ? "" : fmt::format("travel of {}", slot.axis->letter));
        list.add(fmt::format("{}_MAX_POS", slot.id), decimal(high_um / 1000.0));
    }
}

/// "{ a, b, c }" with one value per slot; a stand-in gets `idle`.
template <class Value>
std::string row(const std::vector<Slot>& slots, double idle, Value value) {
    std::string text;
    for (const Slot& slot : slots)
        text += fmt::format("{}{}", text.empty() ? "" : ", ", decimal(slot.axis == nullptr ? idle : value(*slot.axis)));
    return "{ " + text + " }";
}

/// The calculation of the steps per mm, as the reason of the setting.
std::string steps_sum(const std::vector<Slot>& slots) {
    std::string text;
    for (const Slot& slot : slots) {
        if (slot.axis == nullptr) continue;
        const Drive& d = slot.axis->drive;
        text += fmt::format("{}{}: {} x {} x {} / {} {} = {}", text.empty() ? "" : "; ", slot.axis->letter,
                            d.motor_steps, d.microsteps, decimal(d.gear), decimal(d.per_turn_mm),
                            slot.axis->rotary ? "deg" : "mm", decimal(d.steps_per_mm()));
    }
    return "full steps x microsteps x gear / way of a turn. " + text;
}

void add_motion(List& list, const std::vector<Slot>& slots) {
    std::string absolute;
    for (std::size_t i = 0; i < slots.size(); ++i) absolute += i == 0 ? "false" : ", false";
    list.add("AXIS_RELATIVE_MODES", "{ " + absolute + " }", "an entry per axis: without an extruder there is no E");
    list.add("DEFAULT_AXIS_STEPS_PER_UNIT", row(slots, 80, [](const AxisSpec& a) { return a.drive.steps_per_mm(); }),
             steps_sum(slots));
    list.add("DEFAULT_MAX_FEEDRATE", row(slots, 1, [](const AxisSpec& a) { return a.speed_mm_s; }),
             "the machine's speeds, mm/s: what the plan's times rest on");
    list.add("DEFAULT_MAX_ACCELERATION", row(slots, 1, [](const AxisSpec& a) { return a.acceleration_mm_s2; }),
             "the machine's accelerations, mm/s^2");
    double most = 0;
    bool jerks = false;
    for (const Slot& slot : slots) {
        if (slot.axis == nullptr) continue;
        most = std::max(most, slot.axis->acceleration_mm_s2);
        jerks = jerks || slot.axis->jerk_mm_s > 0;
    }
    list.add("DEFAULT_ACCELERATION", decimal(most), "no limit of its own: every axis has its own above");
    list.add("DEFAULT_TRAVEL_ACCELERATION", decimal(most));
    list.add("CLASSIC_JERK", jerks ? "on" : "off",
             jerks ? "as the axes' jerk" : "the machine starts from rest and stops at rest: no jerk is given");
    for (const Slot& slot : slots) {
        if (jerks)
            list.add(fmt::format("DEFAULT_{}JERK", slot.id),
                     decimal(slot.axis == nullptr ? 0.1 : std::max(0.1, slot.axis->jerk_mm_s)));
    }
    list.add("HOMING_FEEDRATE_MM_M", row(slots, 60, [](const AxisSpec& a) { return 60 * a.homing_speed_mm_s; }),
             "homing_speed, in mm a minute");
    list.add("HOMING_BUMP_MM", row(slots, 2, [](const AxisSpec&) { return 2.0; }), "back off, then touch again slowly");
    list.add("HOMING_BUMP_DIVISOR", row(slots, 4, [](const AxisSpec&) { return 4.0; }));
}

/// A pin written by M42 must not be used otherwise: Marlin refuses to write to pins that it uses.
Status check_free_pins(const List& list, const Printer& printer) {
    struct Device {
        const char* name;
        const Switch* device;
    };
    for (const Device& d : {Device{"hooks", &printer.hooks.magnet.coil}, Device{"wall.fork", &printer.wall.fork}}) {
        const auto command = parse_command(d.device->on);
        if (!command || !command->is('M', 42)) continue;
        const std::string pin = fmt::format("{:g}", command->value('P').value_or(0));
        for (const FirmwareSetting& s : list.settings()) {
            if (s.name.ends_with("_PIN") && s.value == pin)
                return input_error("{}: \"{}\": that pin is {} already", d.name, d.device->on, s.name);
        }
    }
    return {};
}

}  // namespace

Result<std::vector<FirmwareSetting>> firmware_settings(const Printer& printer) {
    if (printer.controller.dialect != Dialect::marlin)
        return input_error("controller.dialect: the list is for \"marlin\" (2.1), not for a classic build");
    const auto slots = marlin_axes(printer);
    if (!slots) return tl::unexpected(slots.error());
    if (Status status = check_drives(printer); !status) return tl::unexpected(status.error());
    List list;
    add_board(list, printer);
    add_wire(list, printer);
    add_idle(list, printer.controller.firmware);
    if (Status status = add_motors(list, *slots); !status) return tl::unexpected(status.error());
    if (Status status = add_switches(list, *slots, printer); !status) return tl::unexpected(status.error());
    add_emergency_line(list, printer);
    add_pin_control(list, printer);
    if (Status status = check_free_pins(list, printer); !status) return tl::unexpected(status.error());
    add_travel(list, *slots);
    add_motion(list, *slots);
    return list.take();
}

Result<std::string> firmware_ini(const Printer& printer) {
    const auto settings = firmware_settings(printer);
    if (!settings) return tl::unexpected(settings.error());
    // All in the section "base", which every release reads; the build script of 2.1.1 fails on `all`.
    std::string text = fmt::format(
        "# Marlin {} for the machine {}: put it as Marlin/config.ini into Marlin's source and build.\n"
        "# Written by: pliant firmware PRINTER.toml. Everything that is not here stays as Marlin has it.\n"
        "[config:base]\nini_use_config = base\n\n",
        finds_plugs(printer) ? "2.1.3" : "2.1.1 or 2.1.2.x", c_string(printer.name));
    for (const FirmwareSetting& setting : *settings) {
        if (!setting.reason.empty()) text += fmt::format("# {}\n", setting.reason);
        text += fmt::format("{} = {}\n", lower(setting.name), setting.value);
    }
    return text;
}

}  // namespace pliant::machine
