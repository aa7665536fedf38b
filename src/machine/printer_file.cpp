// From TOML to a Printer: one function per table, then the checks that join tables.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/config.hpp"
#include "machine/gcode.hpp"
#include "machine/printer.hpp"
#include "machine/printer_reading.hpp"
#include "machine/switches.hpp"

namespace pliant::machine {
namespace {

using config::Problems;
using config::Reader;
using namespace reading;

/// A position of the table: a length, or an angle as thousandths of a degree.
int place_um(Reader& r, std::string_view key, double value, bool rotary) {
    return checked_um(r, key, rotary ? value * degrees * 1e-3 : value);
}

Dimension place_dimension(bool rotary) {
    return rotary ? Dimension::angle : Dimension::length;
}

char read_letter(Reader& r, Dialect dialect) {
    const std::string_view known = dialect == Dialect::marlin ? "XYZABCUVW" : "XYZE";
    const std::string letter = r.text("letter");
    if (letter.size() == 1 && known.find(letter[0]) != std::string::npos) return letter[0];
    if (r.has("letter") && dialect == Dialect::marlin) {
        r.problem("letter", "must be one of X Y Z A B C U V W (E only with dialect = \"marlin-classic\")");
    } else if (r.has("letter")) {
        r.problem("letter", "must be one of X Y Z E, which is all that a classic build has");
    }
    return '?';
}

/// How fast, how hard, and where it homes.
void read_motion(Reader& r, AxisSpec& axis) {
    const Dimension speeds = axis.rotary ? Dimension::angular_speed : Dimension::speed;
    const double factor = axis.rotary ? degrees : 1e3;
    axis.speed_mm_s = positive(r, "speed", speeds, factor);
    axis.acceleration_mm_s2 =
        positive(r, "acceleration", axis.rotary ? Dimension::angular_acceleration : Dimension::acceleration, factor);
    axis.jerk_mm_s = not_negative(r, "jerk", speeds, factor);
    const std::string home = r.choice("home", {"min", "max", "hand"});
    axis.homes_to_max = home == "max";
    axis.homes_by_hand = home == "hand";
    if (axis.letter == 'E' && r.has("home") && !axis.homes_by_hand) {
        r.problem("home", "must be \"hand\" for the letter E: a classic build cannot home its extruder");
    }
    if (!axis.homes_by_hand || r.has("homing_speed"))
        axis.homing_speed_mm_s = positive(r, "homing_speed", speeds, factor);
}

/// Steps a mm follow from what can be counted on the machine.
Drive read_drive(Reader& r, bool rotary) {
    Drive d;
    if (r.has("motors")) d.motors = whole(r, "motors", 1, 2);
    if (r.has("motor_steps")) d.motor_steps = whole(r, "motor_steps", 1, 10000);
    if (r.has("microsteps")) d.microsteps = whole(r, "microsteps", 1, 256);
    d.gear = r.number("gear", 1);
    if (!(d.gear > 0 && d.gear <= 1e6))
        r.problem("gear", "must be above 0: turns of the motor for one behind the gear");
    if (r.has("per_turn")) d.per_turn_mm = positive(r, "per_turn", place_dimension(rotary), rotary ? degrees : 1e3);
    return d;
}

AxisSpec read_axis(Reader r, Dialect dialect, bool may_rotate) {
    AxisSpec axis;
    axis.letter = read_letter(r, dialect);
    axis.rotary = may_rotate && r.boolean("rotary", false);
    const auto travel = r.quantities("travel", place_dimension(axis.rotary), 2);
    if (travel.size() == 2) {
        axis.min_um = place_um(r, "travel", travel[0], axis.rotary);
        axis.max_um = place_um(r, "travel", travel[1], axis.rotary);
        if (axis.min_um >= axis.max_um) r.problem("travel", "must be [lowest, highest]");
    }
    read_motion(r, axis);
    axis.drive = read_drive(r, axis.rotary);
    r.finish();
    return axis;
}

Controller read_controller(Reader r) {
    Controller c;
    c.dialect =
        r.choice("dialect", {"marlin", "marlin-classic"}, "marlin") == "marlin" ? Dialect::marlin : Dialect::classic;
    if (r.has("firmware")) {
        const std::string version = r.text("firmware");
        const auto release = marlin_release(version);
        if (!release) r.problem("firmware", fmt::format("\"{}\" is not known; must be 2.1.1, 2.1.2 or 2.1.3", version));
        c.firmware = release.value_or(c.firmware);
    }
    c.baud_rate = whole(r, "baud_rate", 9600, 1000000);
    c.window_lines = static_cast<int>(r.integer("window_lines", c.window_lines));
    c.window_bytes = static_cast<int>(r.integer("window_bytes", c.window_bytes));
    if (c.window_lines < 1 || c.window_lines > 4) r.problem("window_lines", "must be from 1 to 4");
    if (c.window_bytes < 96 || c.window_bytes > 4096) r.problem("window_bytes", "must be from 96 to 4096");
    r.finish();
    return c;
}

Carriage read_carriage(Reader r) {
    Carriage c;
    c.print_um = length_um(r, "print_position", static_cast<int>(-longest_um));
    c.tower_um = length_um(r, "tower_position", static_cast<int>(-longest_um));
    c.back_off_um = length_um(r, "back_off", 1);
    c.shear_um = length_um(r, "shear");
    c.shear_speed_mm_s = speed(r, "shear_speed");
    c.along_y = r.choice("along", {"x", "y"}, "x") == "y";
    r.finish();
    return c;
}

Platform read_platform(Reader r) {
    Platform p;
    const auto size = r.quantities("size", Dimension::length, 2);
    if (size.size() == 2) {
        p.width_um = checked_um(r, "size", size[0]);
        p.depth_um = checked_um(r, "size", size[1]);
        if (p.width_um <= 0 || p.depth_um <= 0) r.problem("size", "must be above 0");
    }
    p.build_height_um = length_um(r, "build_height", 1);
    p.clearance_um = length_um(r, "clearance");
    p.lift_um = length_um(r, "lift", 1);
    p.lift_speed_mm_s = speed(r, "lift_speed");
    p.approach_um = length_um(r, "approach");
    p.approach_speed_mm_s = speed(r, "approach_speed");
    p.settle_s = not_negative(r, "settle", Dimension::time);
    r.finish();
    return p;
}

Tower read_tower(Reader r) {
    Tower t;
    t.slots = whole(r, "slots", 1, 1000);
    t.first_slot_um = length_um(r, "first_slot", static_cast<int>(-longest_um));
    t.pitch_um = length_um(r, "pitch", 1);
    t.clearance_um = length_um(r, "clearance");
    if (r.has("pitch") && t.pitch_um > longest_um / t.slots) r.problem("pitch", "makes a tower over 100 m");
    r.finish();
    return t;
}

/// Stations are a list of any length; the reader wants to know how long.
std::vector<int> read_stations(Reader& r, bool rotary) {
    std::vector<int> stations;
    const config::Value* raw = r.raw("stations");
    const auto* list = raw != nullptr ? std::get_if<config::Array>(&raw->data) : nullptr;
    constexpr std::size_t most = 1000;
    if (list == nullptr || list->empty() || list->size() > most) {
        r.problem("stations", "must be a list of 1 to 1000 positions such as [\"0 mm\", \"180 mm\"]");
        return stations;
    }
    for (const double place : r.quantities("stations", place_dimension(rotary), list->size())) {
        stations.push_back(place_um(r, "stations", place, rotary));
    }
    return stations;
}

Table read_table(Reader r, bool rotary, bool has_tower) {
    Table t;
    t.stations_um = read_stations(r, rotary);
    if (!has_tower) {
        t.cleaning_um = place_um(r, "cleaning", r.quantity("cleaning", place_dimension(rotary)), rotary);
        t.bath_gap_um = length_um(r, "bath_gap", 1);
    }
    r.finish();
    return t;
}

VatShape read_vat_shape(Reader r) {
    VatShape v;
    v.wall_um = length_um(r, "wall", 1);
    v.volume_ml = positive(r, "volume", Dimension::volume, 1e6);
    v.free_volume_ml = positive(r, "free_volume", Dimension::volume, 1e6);
    if (v.free_volume_ml > v.volume_ml) r.problem("free_volume", "is more than the vat's volume");
    v.least_ml = not_negative(r, "least", Dimension::volume, 1e6);
    if (v.least_ml >= v.free_volume_ml && r.has("free_volume")) r.problem("least", "must be less than free_volume");
    r.finish();
    return v;
}

Vat read_vat(Reader& r, const Printer& printer) {
    Vat v;
    v.slot = whole(r, "slot", 1, printer.slot_count());
    v.resin = r.text("resin", "");
    v.fill_ml = not_negative(r, "fill", Dimension::volume, 1e6);
    if (v.fill_ml > printer.vat_shape.free_volume_ml) {
        r.problem("fill", fmt::format("overflows once the platform is in; at most {:.0f} ml",
                                      printer.vat_shape.free_volume_ml));
    }
    if (printer.vat_of_slot(v.slot) != nullptr) r.problem("slot", fmt::format("{} holds a vat already", v.slot));
    if (!v.resin.empty() && printer.find_resin(v.resin) == nullptr) {
        r.problem("resin", fmt::format("\"{}\" has no [resin.{}] table", v.resin, v.resin));
    }
    r.finish();
    return v;
}

void read_outline_offsets(Reader& r, Resin& resin) {
    constexpr int most_um = 10000;
    if (r.has("xy_compensation")) resin.xy_compensation_um = length_um(r, "xy_compensation", -most_um);
    if (resin.xy_compensation_um > most_um) r.problem("xy_compensation", "must be -10 mm to 10 mm");
    if (r.has("bleed_compensation")) resin.bleed_compensation_um = length_um(r, "bleed_compensation");
    if (resin.bleed_compensation_um > most_um) r.problem("bleed_compensation", "must be at most 10 mm");
    if (!r.has("elephant_foot")) return;
    resin.elephant_foot_um = length_um(r, "elephant_foot");
    if (resin.elephant_foot_um > most_um) r.problem("elephant_foot", "must be at most 10 mm");
    resin.elephant_foot_layers =
        r.has("elephant_foot_layers") ? whole(r, "elephant_foot_layers", 1, 10000) : std::max(1, resin.bottom_layers);
}

Resin read_resin(const std::string& name, Reader r) {
    Resin resin;
    resin.name = name;
    resin.exposure_s = positive(r, "exposure", Dimension::time, 1);
    resin.bottom_exposure_s = r.quantity("bottom_exposure", Dimension::time, resin.exposure_s);
    if (resin.bottom_exposure_s < resin.exposure_s) r.problem("bottom_exposure", "is shorter than exposure");
    resin.bottom_layers = r.has("bottom_layers") ? whole(r, "bottom_layers", 0, 10000) : 0;
    resin.transition_layers = r.has("transition_layers") ? whole(r, "transition_layers", 0, 10000) : 0;
    read_outline_offsets(r, resin);
    resin.cure_depth_um = length_um(r, "cure_depth", 1);
    resin.critical_share = r.number("critical_share", 0.8);
    if (!(resin.critical_share > 0 && resin.critical_share <= 1))
        r.problem("critical_share", "must be above 0, at most 1");
    if (r.has("penetration_depth") != r.has("critical_dose")) {
        r.problem("penetration_depth", "and critical_dose go together: they are the working curve");
    } else if (r.has("penetration_depth")) {
        resin.penetration_um = positive(r, "penetration_depth", Dimension::length, 1e6);
        resin.critical_J_m2 = positive(r, "critical_dose", Dimension::dose, 1);
    }
    r.finish();
    return resin;
}

/// Light at evenly spaced coverages: from 0, never falling, at most 1.
std::vector<double> read_grey(Reader& r) {
    if (!r.has("grey")) return {};
    std::vector<double> grey = r.numbers("grey");
    const bool good = grey.size() >= 2 && grey.size() <= 256 && grey.front() == 0 && grey.back() <= 1 &&
                      std::is_sorted(grey.begin(), grey.end()) && grey.back() > 0;
    if (!good)
        r.problem("grey", "must be 2 to 256 numbers that begin with 0, never fall, and end above 0, at most at 1");
    return grey;
}

/// How the image lies on the platform, besides mirrors.
void read_alignment(Reader& r, Projector& p) {
    p.rotation_deg = r.number("rotation", 0);
    if (!(std::abs(p.rotation_deg) <= 360)) r.problem("rotation", "must be -360 to 360 degrees");
    if (!r.has("offset")) return;
    const std::vector<double> offset = r.quantities("offset", Dimension::length, 2);
    if (offset.size() != 2) return;
    p.offset_x_um = checked_um(r, "offset", offset[0]);
    p.offset_y_um = checked_um(r, "offset", offset[1]);
}

Projector read_projector(Reader r) {
    Projector p;
    p.width_px = whole(r, "width", 1, 32768);
    p.height_px = whole(r, "height", 1, 32768);
    constexpr double parts = 1e6;  // of a micrometre; what is left beyond is the rounding of "100 um" to metres
    p.pixel_um = std::round(parts * positive(r, "pixel", Dimension::length, 1e6)) / parts;
    p.mirror_x = r.boolean("mirror_x", false);
    p.mirror_y = r.boolean("mirror_y", false);
    read_alignment(r, p);
    p.grey = read_grey(r);
    p.mask = r.text("mask", "");
    p.irradiance_W_m2 = not_negative(r, "irradiance", Dimension::irradiance);
    p.delay_s = not_negative(r, "delay", Dimension::time);
    r.finish();
    return p;
}

Limits read_limits(Reader r) {
    Limits limits;
    limits.exposure_s = r.quantity("exposure", Dimension::time, limits.exposure_s);
    limits.cleaning_s = r.quantity("cleaning", Dimension::time, limits.cleaning_s);
    for (const auto& [key, value] : {std::pair{"exposure", limits.exposure_s}, {"cleaning", limits.cleaning_s}}) {
        if (!(value > 0 && value <= 3600)) r.problem(key, "must be above 0, at most an hour");
    }
    r.finish();
    return limits;
}

/// A switch may only switch: a motion hidden in the printer file would pass every interlock of the planner.
Switch read_switch(Reader r) {
    Switch s{r.text("on", ""), r.text("off", "")};
    for (const auto& [key, text] : {std::pair{"on", s.on}, std::pair{"off", s.off}}) {
        if (text.empty()) continue;
        const auto command = parse_command(text);
        const bool switches = command && command->letter == 'M' &&
                              (command->number == 106 || command->number == 107 || command->number == 42);
        if (!switches) r.problem(key, "must be an M106, M107 or M42 command such as \"M106 P1 S255\"");
    }
    if (s.on.empty() != s.off.empty()) r.problem("on", "and \"off\" go together");
    r.finish();
    return s;
}

std::string command_key(const Switch& s) {
    const auto parsed = parse_command(s.on);
    return parsed ? fmt::format("{}{}", parsed->number == 42 ? "pin " : "fan ", parsed->value('P').value_or(0)) : s.on;
}

/// [[fan]], one table each; [fans] is the older form of a single one.
void read_fans(Reader& root, Printer& p) {
    if (root.has("fans") && root.has("fan")) root.problem("fans", "is the older form of [[fan]]; keep one of them");
    const Switch single = read_switch(root.table("fans", false));
    if (!single.on.empty()) p.fans.push_back(single);
    if (!root.has("fan")) return;
    for (Reader& r : root.tables("fan")) {
        Switch fan = read_switch(r);
        const auto same = [&](const Switch& other) { return command_key(other) == command_key(fan); };
        if (fan.on.empty())
            root.problem("fan", "needs \"on\" and \"off\"");
        else if (std::any_of(p.fans.begin(), p.fans.end(), same) || (!p.pump.on.empty() && same(p.pump)))
            root.problem("fan", fmt::format("\"{}\" is the output of another fan or of the pump", fan.on));
        else
            p.fans.push_back(std::move(fan));
    }
}

LimitSwitch read_limit_switch(Reader& r, const Printer& p) {
    const std::string axis = r.choice("axis", {"carriage", "platform", "tower", "table"});
    LimitSwitch s;
    for (const Axis a : all_axes) {
        if (axis_name(a) == axis) s.axis = a;
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
            r.problem("input", fmt::format("{} is the limit switch of the {}", door.input, axis_name(s.axis)));
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
        line.pin = whole(r, "pin", 0, last_pin);
    } else {
        line.device = r.text("device");
        if (r.has("device") && line.device.empty()) r.problem("device", "must name a serial port or a file");
    }
    if (line.signal == Signal::file) line.stop_high = r.choice("stop", {"high", "low"}, "high") == "high";
    r.finish();
    return line;
}

/// Which axes there are follows from where the vats are kept.
void read_axes(Reader r, Printer& printer, bool has_tower, bool has_table) {
    for (const Axis axis : all_axes) {
        const bool wanted = axis == Axis::platform || (axis == Axis::table ? has_table : has_tower);
        if (!wanted) {
            if (r.has(axis_name(axis))) {
                r.problem(axis_name(axis), fmt::format("needs a [{}] table", axis == Axis::table ? "table" : "tower"));
            }
            continue;
        }
        auto& spec = printer.axes[static_cast<std::size_t>(axis)];
        spec = read_axis(r.table(axis_name(axis)), printer.controller.dialect, axis == Axis::table);
        for (const Axis other : all_axes) {
            if (other < axis && printer.axis(other).letter == spec.letter && spec.letter != '?') {
                r.problem(axis_name(axis), fmt::format("has the letter of the {} axis", axis_name(other)));
            }
        }
    }
    r.finish();
}

void read_vats(Reader& root, Printer& printer) {
    auto vats = root.tables("vat");
    if (vats.empty()) root.problem("vat", "at least one [[vat]] is needed");
    for (Reader& r : vats) printer.vats.push_back(read_vat(r, printer));
}

/// Every station must lie within the travel of its axis.
void check_stations(Reader& root, const Printer& p) {
    const auto within = [&](Axis axis, int um, std::string_view what) {
        const AxisSpec& a = p.axis(axis);
        if (um >= a.min_um && um <= a.max_um) return;
        root.problem(fmt::format("axis.{}.travel", axis_name(axis)),
                     fmt::format("{} at {:.3f} mm is outside", what, um / 1000.0));
    };
    for (const int station_um : p.table.stations_um) within(Axis::table, station_um, "a station");
    if (p.store() == Store::table) within(Axis::table, p.table.cleaning_um, "the cleaning station");
    within(Axis::platform, 0, "the floor of the vat");
    within(Axis::platform, p.clear_um(p.platform.build_height_um) + p.cleaning.stroke_z_um,
           "the tallest part, lifted clear of the vat for cleaning,");
    if (p.store() != Store::tower) return;
    within(Axis::carriage, p.carriage.print_um, "the print position");
    within(Axis::carriage, p.carriage.print_um + p.carriage.shear_um, "the shear stroke");
    within(Axis::carriage, p.carriage.tower_um, "the tower position");
    within(Axis::tower, p.level_um(1) - p.hooks.travel_um, "slot 1, lowered,");
    within(Axis::tower, p.level_um(p.tower.slots), "the last slot");
}

void check_tower_geometry(Reader& root, const Printer& p) {
    const Carriage& c = p.carriage;
    if (c.print_um + c.shear_um + p.cleaning.stroke_x_um + c.back_off_um >= c.tower_um) {
        root.problem("carriage.tower_position", "leaves no room for shear, back_off and the cleaning stroke");
    }
    if (p.hooks.travel_um >= p.tower.clearance_um) {
        root.problem("hooks.travel", "must be less than the tower's clearance");
    }
    if (p.axis(Axis::carriage).home_um() > c.tower_um - c.back_off_um) {
        root.problem("axis.carriage.home", "ends at the tower, which then could not be homed");
    }
}

void check_geometry(Reader& root, const Printer& p) {
    if (p.store() == Store::tower) check_tower_geometry(root, p);
    if (p.axis(Axis::platform).home_um() < p.clear_um(0)) {
        root.problem("axis.platform.home", "must end clear of the vat (home = \"max\")");
    }
    const auto& stations = p.table.stations_um;
    for (std::size_t i = 0; i < stations.size(); ++i) {
        const bool on_cleaning = p.store() == Store::table && p.table_at(stations[i], p.table.cleaning_um);
        if (on_cleaning) root.problem("table.stations", fmt::format("station {} is the cleaning station", i + 1));
        for (std::size_t k = 0; k < i; ++k) {
            if (p.table_at(stations[i], stations[k])) {
                root.problem("table.stations", fmt::format("stations {} and {} are the same place", k + 1, i + 1));
            }
        }
    }
}

/// A list of limit switches must be whole: an axis without the one that it homes to would run into its end.
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
                                                     axis_name(axis), spec.homes_to_max ? "max" : "min"));
    }
}

/// Resins that a cleaning pair names must be known, or a slip would go unnoticed.
void check_pairs(Reader& root, const Printer& p) {
    for (const CleaningPair& pair : p.cleaning.pairs) {
        for (const std::string& resin : {pair.from, pair.to}) {
            if (p.find_resin(resin) != nullptr) continue;
            root.problem("cleaning.pair",
                         fmt::format("names resin \"{}\", which has no [resin.{}] table", resin, resin));
        }
    }
}

/// The store: a tower with its carriage and hooks, a table, both, or nothing.
void read_store(Reader& root, Printer& p, bool has_tower, bool has_table) {
    if (has_tower) {
        p.carriage = read_carriage(root.table("carriage"));
        p.tower = read_tower(root.table("tower"));
        Reader hooks = root.table("hooks");
        p.hooks = {length_um(hooks, "travel", 1), speed(hooks, "speed")};
        hooks.finish();
    }
    if (has_table) p.table = read_table(root.table("table"), p.axis(Axis::table).rotary, has_tower);
    if (p.slot_count() > 1000) root.problem("tower.slots", "makes more than 1000 places for vats");
}

Printer read_printer(Reader& root) {
    Printer p;
    p.name = root.text("name");
    if (root.has("layer_height")) p.layer_um = length_um(root, "layer_height", 1);
    p.controller = read_controller(root.table("controller"));
    const bool has_tower = root.has("tower") || root.has("carriage") || root.has("hooks");
    const bool has_table = root.has("table");
    read_axes(root.table("axis"), p, has_tower, has_table);
    p.platform = read_platform(root.table("platform"));
    read_store(root, p, has_tower, has_table);
    p.vat_shape = read_vat_shape(root.table("vat_shape"));
    for (auto& [name, r] : root.named_tables("resin")) p.resins.push_back(read_resin(name, r));
    read_vats(root, p);
    p.projector = read_projector(root.table("projector"));
    p.cleaning = read_cleaning(root.table("cleaning", p.store() != Store::none), p.store(), p.platform.clearance_um);
    if (root.has("solution")) {
        p.solution = read_solution(root.table("solution"));
        if (p.store() == Store::none) root.problem("solution", "belongs to a machine that cleans: one with more vats");
    }
    read_sprinklers(root, p);
    p.pump = read_switch(root.table("pump", false));
    read_fans(root, p);
    read_limit_switches(root, p);
    if (root.has("door")) p.door = read_door(root.table("door"), p);
    if (root.has("emergency_line")) p.emergency_line = read_emergency_line(root.table("emergency_line"));
    p.limits = read_limits(root.table("limits", false));
    root.finish();
    return p;
}

Result<Printer> from_document(const config::Document& document) {
    Problems problems(document.file.string());
    Reader root(document.root, problems);
    Printer printer = read_printer(root);
    if (problems.empty()) {
        check_stations(root, printer);
        check_geometry(root, printer);
        check_pairs(root, printer);
        check_limit_switches(root, printer);
    }
    if (auto status = problems.status(); !status) return tl::unexpected(status.error());
    return printer;
}

}  // namespace

Result<Printer> load_printer(const std::filesystem::path& path) {
    return config::load(path).and_then(from_document);
}

Result<Printer> parse_printer(std::string_view text, const std::filesystem::path& file) {
    return config::parse(text, file).and_then(from_document);
}

}  // namespace pliant::machine
