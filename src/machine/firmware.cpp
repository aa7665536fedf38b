#include "machine/firmware.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "machine/gcode.hpp"
#include "machine/switches.hpp"

namespace pliant::machine {
namespace {

constexpr int ramps_outputs = 5;
constexpr double most_steps_s = 40000;  // what an 8-bit board of 16 MHz can make

/// One of Marlin's axes, in its own order. An extra axis needs all before it; one that the machine does not have is a
/// stand-in that never moves.
struct Slot {
    std::string_view id;  ///< X Y Z, then I J K
    const AxisSpec* axis = nullptr;
};

/// Where a motor is plugged in, with the pins of that socket.
struct Socket {
    std::string_view name;
    int step, dir, enable;
};
constexpr std::array<Socket, 2> free_sockets = {Socket{"E0", 26, 28, 24}, Socket{"E1", 36, 34, 30}};

std::string number(double value) {
    std::string text = fmt::format("{:.4f}", value);
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
    return text;
}

/// Letters beyond X Y Z take Marlin's extra axes in the order of the alphabet that AXISn_NAME allows.
Result<std::vector<Slot>> marlin_axes(const Printer& printer) {
    std::vector<Slot> slots = {{"X", nullptr}, {"Y", nullptr}, {"Z", nullptr}};
    constexpr std::array<std::string_view, 3> extra = {"I", "J", "K"};
    const std::string_view order = "XYZABCUVW";
    std::vector<const AxisSpec*> axes;
    for (const AxisSpec& axis : printer.axes) {
        if (axis.present()) axes.push_back(&axis);
    }
    std::sort(axes.begin(), axes.end(),
              [&](const AxisSpec* a, const AxisSpec* b) { return order.find(a->letter) < order.find(b->letter); });
    for (const AxisSpec* axis : axes) {
        const std::size_t at = order.find(axis->letter);
        if (at == std::string_view::npos)
            return input_error("letter {}: Marlin 2.1 has no such axis; the list is for dialect = \"marlin\"",
                               axis->letter);
        if (at < 3) {
            slots[at].axis = axis;
        } else if (slots.size() == 3 + extra.size()) {
            return input_error("letter {}: a fourth axis beyond X Y Z is more than this list knows", axis->letter);
        } else {
            slots.push_back({extra[slots.size() - 3], axis});
        }
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
            return input_error("axis.{}.motors: only Z may have two here", axis_name(a));
        if (!axis.drive.known())
            return input_error("axis.{}: steps are not known; give per_turn, microsteps and gear", axis_name(a));
        const double steps_s = axis.speed_mm_s * axis.drive.steps_per_mm();
        if (steps_s > most_steps_s) {
            return input_error(
                "axis.{}: {:.0f} steps a second at full speed; an 8-bit board makes {:.0f}: fewer microsteps",
                axis_name(a), steps_s, most_steps_s);
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
    std::vector<FirmwareSetting> take() { return std::move(settings_); }

private:
    std::vector<FirmwareSetting> settings_;
};

/// M106 P2: the output that would heat a hotend is free without one.
void add_third_output(List& list, const Printer& printer) {
    std::vector<Switch> devices = printer.fans;
    devices.push_back(printer.pump);
    for (const Switch& device : devices) {
        const auto command = parse_command(device.on);
        if (command && command->is('M', 106) && command->value('P') == 2.0)
            return list.add("FAN2_PIN", "10", fmt::format("{}: D10, free without an extruder", device.on));
    }
}

/// The relay that M112 drops: what Marlin calls the switch of a power supply.
void add_emergency_line(List& list, const Printer& printer) {
    if (printer.emergency_line.signal != EmergencyLine::Signal::controller) return;
    list.add("PSU_CONTROL", "on", "the emergency line: a relay that holds the power of motors, pump, fans and lamp");
    list.add("PS_ON_PIN", std::to_string(printer.emergency_line.pin), "as emergency_line.pin");
    list.add("PSU_ACTIVE_STATE", "HIGH", "the relay is held while all is well, and falls when M112 kills the firmware");
    list.add("PSU_DEFAULT_OFF", "off", "power as soon as the firmware runs; no program may send M80 or M81");
}

void add_board(List& list, const Printer& printer) {
    list.add("MOTHERBOARD", "BOARD_RAMPS_14_EFF",
             "RAMPS 1.4 whose outputs D9 and D8 are fans: M106 P0 switches the fans on D9, M106 P1 the pump on D8");
    add_third_output(list, printer);
    list.add("SERIAL_PORT", "0", "the USB socket of the Mega 2560");
    list.add("BAUDRATE", std::to_string(printer.controller.baud_rate), "as controller.baud_rate");
    list.add("CUSTOM_MACHINE_NAME", fmt::format("\"{}\"", printer.name), "what M115 answers as MACHINE_TYPE");
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

void add_idle(List& list) {
    list.add("DEFAULT_STEPPER_DEACTIVE_TIME", "0",
             "motors never let go: platform and tower would sink in a long wash or a pause, unnoticed");
    list.add("DEFAULT_STEPPER_TIMEOUT_SEC", "0", "the same by its name since 2.1.3");
    list.add("NO_MOTION_BEFORE_HOMING", "on", "soft limits hold on homed axes only: nothing moves before");
    list.add("MIN_SOFTWARE_ENDSTOPS", "on", "nothing leaves its travel, whatever is sent");
    list.add("MAX_SOFTWARE_ENDSTOPS", "on");
    list.add("SLOWDOWN", "off", "moves keep their speed when few are queued: times are as planned");
}

void add_motors(List& list, const std::vector<Slot>& slots) {
    std::size_t used = 0;
    for (const Slot& slot : slots) {
        const bool extra = slot.id >= "I" && slot.id <= "K";
        list.add(fmt::format("{}_DRIVER_TYPE", slot.id), "A4988",
                 slot.axis == nullptr
                     ? "no axis of the machine: Marlin wants one before Z and the extra axes; nothing is plugged in"
                     : fmt::format("letter {}; or the name of the driver that is plugged in", slot.axis->letter));
        if (extra) {
            const int n = 4 + static_cast<int>(slot.id[0] - 'I');
            list.add(fmt::format("AXIS{}_NAME", n), fmt::format("'{}'", slot.axis->letter), "its letter in G-code");
            list.add(fmt::format("AXIS{}_ROTATES", n), slot.axis->rotary ? "on" : "off",
                     slot.axis->rotary ? "it turns: degrees" : "it is linear: mm, which is not Marlin's default");
        }
        const bool second = slot.axis != nullptr && slot.axis->drive.motors > 1;
        if (second)
            list.add("Z2_DRIVER_TYPE", "A4988", "the second screw has a driver of its own, which steps with the first");
        if ((extra || second) && used < free_sockets.size()) {
            const Socket& socket = free_sockets[used++];
            const std::string_view id = extra ? slot.id : "Z2";
            list.add(fmt::format("{}_STEP_PIN", id), std::to_string(socket.step),
                     fmt::format("socket {}, free without an extruder", socket.name));
            list.add(fmt::format("{}_DIR_PIN", id), std::to_string(socket.dir));
            list.add(fmt::format("{}_ENABLE_PIN", id), std::to_string(socket.enable));
        }
    }
}

/// A switch input of the board by the name that M119 has for it, and its pin.
struct Input {
    std::string_view name;
    int pin;
};
constexpr std::array<Input, 2> free_inputs = {Input{"x_max", 2}, Input{"y_max", 15}};

/// Inputs that no extra axis may take: a limit switch or the door is on them.
bool is_taken(const Printer& printer, std::string_view input) {
    if (printer.door.input == input) return true;
    const auto switches = switches_of(printer);
    return std::any_of(switches.begin(), switches.end(),
                       [&](const LimitSwitch& s) { return switch_names(printer, s).front() == input; });
}

void add_plug(List& list, std::string_view id, bool at_max, bool inverted, const std::string& reason = "") {
    const std::string_view end = at_max ? "MAX" : "MIN";
    list.add(fmt::format("USE_{}{}_PLUG", id, end), "on", reason);
    list.add(fmt::format("{}_{}_ENDSTOP_INVERTING", id, end), inverted ? "true" : "false",
             inverted ? "inverted = true: a normally open switch" : "");
}

std::string upper(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return result;
}

void add_door(List& list, const DoorSwitch& door) {
    if (!door.present()) return;
    const std::string id = upper(door.input.substr(0, 1));
    if (door.input.ends_with("_min") || door.input.ends_with("_max"))
        return add_plug(list, id, door.input.ends_with("_max"), door.inverted,
                        fmt::format("the door: M119 calls its switch {}", door.input));
    list.add(door.input == "filament" ? "FIL_RUNOUT_STATE" : "Z_MIN_PROBE_ENDSTOP_INVERTING",
             door.input == "filament" ? (door.inverted ? "LOW" : "HIGH") : (door.inverted ? "true" : "false"),
             fmt::format("the door is on the input {}: enable it as your board needs", door.input));
}

Status add_switches(List& list, const std::vector<Slot>& slots, const Printer& printer) {
    list.add("ENDSTOPPULLUPS", "on", "normally closed switches to ground: a broken wire reads as pressed, and stops");
    const auto switches = switches_of(printer);
    auto input = free_inputs.begin();
    for (const Slot& slot : slots) {
        const bool to_max = slot.axis != nullptr && slot.axis->homes_to_max;
        const std::string_view end = to_max ? "MAX" : "MIN";
        list.add(fmt::format("{}_HOME_DIR", slot.id), to_max ? "1" : "-1",
                 slot.axis == nullptr ? "never homed" : fmt::format("home = \"{}\"", to_max ? "max" : "min"));
        bool inverted = false, far = false, far_inverted = false;
        for (const LimitSwitch& s : switches) {
            if (&printer.axis(s.axis) != slot.axis) continue;
            (s.at_max == to_max ? inverted : far_inverted) = s.inverted;
            far = far || s.at_max != to_max;
        }
        add_plug(list, slot.id, to_max, inverted);
        if (far) add_plug(list, slot.id, !to_max, far_inverted, "the switch at the other end");
        if (to_max && !far) list.add(fmt::format("USE_{}MIN_PLUG", slot.id), "off");
        if (slot.id < "I" || slot.id > "K") continue;
        while (input != free_inputs.end() && is_taken(printer, input->name)) ++input;
        if (input == free_inputs.end() || far)
            return input_error("letter {}: RAMPS 1.4 has no free input for its limit switch",
                               slot.axis == nullptr ? '?' : slot.axis->letter);
        list.add(
            fmt::format("{}_{}_PIN", slot.id, end), std::to_string(input->pin),
            fmt::format("the input {}, which {} leaves free", upper(input->name), upper(input->name.substr(0, 1))));
        ++input;
    }
    add_door(list, printer.door);
    list.add("VALIDATE_HOMING_ENDSTOPS", "on", "homing that ends without its switch is an error");
    return {};
}

void add_travel(List& list, const std::vector<Slot>& slots) {
    for (const Slot& slot : slots) {
        const int low_um = slot.axis == nullptr ? 0 : slot.axis->min_um;
        const int high_um = slot.axis == nullptr ? 1000 : slot.axis->max_um;
        if (slot.id == "X" || slot.id == "Y")
            list.add(fmt::format("{}_BED_SIZE", slot.id), number((high_um - low_um) / 1000.0), "its travel");
        list.add(fmt::format("{}_MIN_POS", slot.id), number(low_um / 1000.0),
                 slot.axis == nullptr ? "" : fmt::format("travel of {}", slot.axis->letter));
        list.add(fmt::format("{}_MAX_POS", slot.id), number(high_um / 1000.0));
    }
}

/// "{ a, b, c }" of one value of every slot; a stand-in has `idle`.
template <class Value>
std::string row(const std::vector<Slot>& slots, double idle, Value value) {
    std::string text;
    for (const Slot& slot : slots)
        text += fmt::format("{}{}", text.empty() ? "" : ", ", number(slot.axis == nullptr ? idle : value(*slot.axis)));
    return "{ " + text + " }";
}

/// The arithmetic of an axis' steps, for its reason.
std::string steps_sum(const std::vector<Slot>& slots) {
    std::string text;
    for (const Slot& slot : slots) {
        if (slot.axis == nullptr) continue;
        const Drive& d = slot.axis->drive;
        text += fmt::format("{}{}: {} x {} x {} / {} {} = {}", text.empty() ? "" : "; ", slot.axis->letter,
                            d.motor_steps, d.microsteps, number(d.gear), number(d.per_turn_mm),
                            slot.axis->rotary ? "deg" : "mm", number(d.steps_per_mm()));
    }
    return "full steps x microsteps x gear / way of a turn. " + text;
}

void add_motion(List& list, const std::vector<Slot>& slots) {
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
    list.add("DEFAULT_ACCELERATION", number(most), "no limit of its own: every axis has its own above");
    list.add("DEFAULT_TRAVEL_ACCELERATION", number(most));
    list.add("CLASSIC_JERK", jerks ? "on" : "off",
             jerks ? "as the axes' jerk" : "the machine starts from rest and stops at rest: no jerk is given");
    for (const Slot& slot : slots) {
        if (jerks)
            list.add(fmt::format("DEFAULT_{}JERK", slot.id),
                     number(slot.axis == nullptr ? 0.1 : std::max(0.1, slot.axis->jerk_mm_s)));
    }
    list.add("HOMING_FEEDRATE_MM_M", row(slots, 60, [](const AxisSpec& a) { return 60 * a.homing_speed_mm_s; }),
             "homing_speed, in mm a minute");
    list.add("HOMING_BUMP_MM", row(slots, 2, [](const AxisSpec&) { return 2.0; }), "back off, then touch again slowly");
    list.add("HOMING_BUMP_DIVISOR", row(slots, 4, [](const AxisSpec&) { return 4.0; }));
}

// --- what a board says ----------------------------------------------------------------------------------------------

std::string_view trimmed(std::string_view line) {
    constexpr std::string_view blanks = " \t\r";
    line.remove_prefix(std::min(line.size(), line.find_first_not_of(blanks)));
    const std::size_t last = line.find_last_not_of(blanks);
    return line.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

/// "X80.00 Y80.00 ...": letters with numbers; whatever is damaged is left out.
std::map<char, double> read_words(std::string_view words) {
    std::map<char, double> values;
    while (!(words = trimmed(words)).empty()) {
        const std::string_view word = words.substr(0, words.find(' '));
        words.remove_prefix(word.size());
        if (word.size() < 2 || word[0] < 'A' || word[0] > 'Z') continue;
        const std::string text(word.substr(1));
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        if (end == text.c_str() + text.size() && std::isfinite(value)) values[word[0]] = value;
    }
    return values;
}

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return result;
}

void read_name(std::string_view line, BoardReport& board) {
    const std::string_view rest = line.substr(line.find(':') + 1);
    const std::size_t end = std::min(rest.find(" SOURCE_CODE_URL:"), rest.find(" PROTOCOL_VERSION:"));
    board.name = trimmed(rest.substr(0, end));
    const std::string_view key = "EXTRUDER_COUNT:";
    const std::size_t at = line.find(key);
    if (at != std::string_view::npos && at + key.size() < line.size()) {
        const char digit = line[at + key.size()];
        if (digit >= '0' && digit <= '9') board.extruders = digit - '0';
    }
}

void read_line(std::string_view line, BoardReport& board) {
    if (line.starts_with("echo:")) line = trimmed(line.substr(5));
    if (line.starts_with("FIRMWARE_NAME:")) return read_name(line, board);
    if (line.starts_with("Cap:")) {
        const std::size_t at = line.rfind(':');
        if (at > 4 && at + 2 == line.size())
            board.capabilities[std::string(line.substr(4, at - 4))] = line[at + 1] == '1';
        return;
    }
    for (const std::string_view code : {"M92", "M201", "M203", "M205"}) {
        if (!line.starts_with(code) || line.substr(code.size(), 1) != " ") continue;
        for (const auto& [letter, value] : read_words(line.substr(code.size())))
            board.values[std::string(code)][letter] = value;
        return;
    }
    if (line.starts_with("M113 ")) {
        const auto words = read_words(line.substr(5));
        if (const auto s = words.find('S'); s != words.end()) board.busy_every_s = s->second;
        return;
    }
    if (const auto reading = parse_switch(line)) board.switches.push_back(reading->name);
}

class Board {
public:
    Board(const BoardReport& board, const Printer& printer) : board_(board), printer_(printer) {}

    std::vector<std::string> problems() {
        if (board_.name.empty()) {
            problems_.push_back("M115: no answer that names a firmware; is it a Marlin, and at this baud rate?");
            return std::move(problems_);
        }
        if (board_.name.find("Marlin") == std::string::npos)
            problems_.push_back(fmt::format("M115: the firmware is \"{}\": not a Marlin", board_.name));
        capabilities();
        if (printer_.controller.dialect == Dialect::marlin && board_.extruders.value_or(0) > 0)
            problems_.push_back(fmt::format("M115: {} extruders: build with EXTRUDERS 0", *board_.extruders));
        for (const Axis axis : all_axes) {
            if (printer_.axis(axis).present()) check_axis(axis, printer_.axis(axis));
        }
        for (const LimitSwitch& s : switches_of(printer_)) check_switch(s);
        if (printer_.door.present() && !names_one({printer_.door.input}))
            problems_.push_back(fmt::format("M119: no {}: the door's switch is there", printer_.door.input));
        return std::move(problems_);
    }

private:
    void capabilities() {
        const auto parser = board_.capabilities.find("EMERGENCY_PARSER");
        if (parser == board_.capabilities.end() || !parser->second)
            problems_.push_back(
                "M115: no EMERGENCY_PARSER: an emergency stop waits for the queue; build with EMERGENCY_PARSER");
        if (board_.busy_every_s && !(*board_.busy_every_s > 0 && *board_.busy_every_s <= 10)) {
            problems_.push_back(fmt::format("M113: busy every {:g} s: must be 1 to 10 (DEFAULT_KEEPALIVE_INTERVAL 2)",
                                            *board_.busy_every_s));
        } else if (!board_.busy_every_s) {
            problems_.push_back("M113: no answer: build with HOST_KEEPALIVE_FEATURE");
        }
    }

    void check_axis(Axis which, const AxisSpec& axis) {
        if (axis.drive.known()) compare("M92", "steps a mm", which, axis.drive.steps_per_mm(), 1e-3);
        compare("M203", "mm/s", which, axis.speed_mm_s, 1e-2);
        compare("M201", "mm/s^2", which, axis.acceleration_mm_s2, 1e-2);
    }

    void compare(const std::string& code, std::string_view unit, Axis which, double wanted, double tolerance) {
        const char letter = printer_.axis(which).letter;
        const auto values = board_.values.find(code);
        if (values == board_.values.end()) {
            if (missing_.empty() || missing_.back() != code)
                problems_.push_back(fmt::format("M503: does not say {}", missing_.emplace_back(code)));
            return;
        }
        const auto value = values->second.find(letter);
        if (value == values->second.end()) {
            problems_.push_back(fmt::format("M503: {} does not name {} (the {}): the firmware has no such axis", code,
                                            letter, axis_name(which)));
        } else if (!(std::abs(value->second - wanted) <= tolerance * wanted)) {
            problems_.push_back(fmt::format("M503: {} {} is {}, the printer file has {} {}: send {} {}{}", code, letter,
                                            number(value->second), number(wanted), unit, code, letter, number(wanted)));
        }
    }

    [[nodiscard]] bool names_one(const std::vector<std::string>& names) const {
        return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
            return std::find(board_.switches.begin(), board_.switches.end(), name) != board_.switches.end();
        });
    }

    void check_switch(const LimitSwitch& s) {
        const std::vector<std::string> names = switch_names(printer_, s);
        if (names_one(names)) return;
        const bool home = printer_.axis(s.axis).homes_to_max == s.at_max;
        problems_.push_back(fmt::format("M119: no {}: the {} {}", names.front(), axis_name(s.axis),
                                        home ? "homes there" : "has a limit switch there"));
    }

    const BoardReport& board_;
    const Printer& printer_;
    std::vector<std::string> problems_;
    std::vector<std::string> missing_;
};

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
    add_idle(list);
    add_motors(list, *slots);
    if (Status status = add_switches(list, *slots, printer); !status) return tl::unexpected(status.error());
    add_emergency_line(list, printer);
    add_travel(list, *slots);
    add_motion(list, *slots);
    return list.take();
}

Result<std::string> firmware_ini(const Printer& printer) {
    const auto settings = firmware_settings(printer);
    if (!settings) return tl::unexpected(settings.error());
    std::string text = fmt::format(
        "# Marlin 2.1 for the machine \"{}\": put it as Marlin/config.ini into Marlin's source and build.\n"
        "# Written by: pliant firmware PRINTER.toml. Everything that is not here stays as Marlin has it.\n"
        "[config:base]\nini_use_config = all\n\n[config:pliant]\n",
        printer.name);
    for (const FirmwareSetting& setting : *settings) {
        if (!setting.reason.empty()) text += fmt::format("# {}\n", setting.reason);
        text += fmt::format("{} = {}\n", lower(setting.name), setting.value);
    }
    return text;
}

BoardReport parse_board_report(std::string_view text) {
    constexpr std::size_t most = 1000000;
    text = text.substr(0, most);
    BoardReport board;
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), line.size() + 1));
        read_line(trimmed(line), board);
    }
    return board;
}

std::vector<std::string> check_board(const BoardReport& board, const Printer& printer) {
    return Board(board, printer).problems();
}

}  // namespace pliant::machine
