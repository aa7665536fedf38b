// From TOML to a Printer: one function per table, then the checks that join tables.
#include <algorithm>
#include <cmath>
#include <string>

#include "core/config.hpp"
#include "machine/gcode.hpp"
#include "machine/printer.hpp"

namespace pliant::machine {
namespace {

using config::Problems;
using config::Reader;

constexpr double longest_um = 1e8;  // 100 m: far beyond any machine, and safe to add up in an int

int checked_um(Reader& r, std::string_view key, double metres) {
    const double um = metres * 1e6;
    if (std::abs(um) <= longest_um) return static_cast<int>(std::lround(um));
    r.problem(key, "is over 100 m");
    return 0;
}

int length_um(Reader& r, std::string_view key, int low_um = 0) {
    const int um = checked_um(r, key, r.quantity(key, Dimension::length));
    if (r.has(key) && um < low_um) r.problem(key, fmt::format("must be at least {} um", low_um));
    return um;
}

double positive(Reader& r, std::string_view key, Dimension dimension, double factor) {
    const double value = r.quantity(key, dimension) * factor;
    if (r.has(key) && !(value > 0)) r.problem(key, "must be above 0");
    return value;
}

double not_negative(Reader& r, std::string_view key, Dimension dimension, double factor = 1) {
    const double value = r.quantity(key, dimension, 0) * factor;
    if (value < 0) r.problem(key, "must not be negative");
    return value;
}

int whole(Reader& r, std::string_view key, int low, int high) {
    const auto value = r.integer(key);
    if (r.has(key) && (value < low || value > high)) {
        r.problem(key, fmt::format("is {}, must be from {} to {}", value, low, high));
    }
    return static_cast<int>(std::clamp<std::int64_t>(value, low, high));
}

double speed(Reader& r, std::string_view key) {
    return positive(r, key, Dimension::speed, 1e3);
}

AxisSpec read_axis(Reader r) {
    AxisSpec axis;
    const std::string letter = r.text("letter");
    if (r.has("letter") &&
        !(letter.size() == 1 && std::string_view("XYZABCUVWE").find(letter[0]) != std::string::npos)) {
        r.problem("letter", "must be one of X Y Z A B C U V W E");
    } else if (!letter.empty()) {
        axis.letter = letter[0];
    }
    const auto travel = r.quantities("travel", Dimension::length, 2);
    if (travel.size() == 2) {
        axis.min_um = checked_um(r, "travel", travel[0]);
        axis.max_um = checked_um(r, "travel", travel[1]);
        if (axis.min_um >= axis.max_um) r.problem("travel", "must be [lowest, highest]");
    }
    axis.speed_mm_s = speed(r, "speed");
    axis.acceleration_mm_s2 = positive(r, "acceleration", Dimension::acceleration, 1e3);
    axis.homes_to_max = r.choice("home", {"min", "max"}) == "max";
    axis.homing_speed_mm_s = speed(r, "homing_speed");
    r.finish();
    return axis;
}

Controller read_controller(Reader r) {
    Controller c;
    c.dialect = r.choice("dialect", {"marlin"}, "marlin");
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

VatShape read_vat_shape(Reader r) {
    VatShape v;
    v.wall_um = length_um(r, "wall", 1);
    v.volume_ml = positive(r, "volume", Dimension::volume, 1e6);
    v.free_volume_ml = positive(r, "free_volume", Dimension::volume, 1e6);
    if (v.free_volume_ml > v.volume_ml) r.problem("free_volume", "is more than the vat's volume");
    r.finish();
    return v;
}

Vat read_vat(Reader& r, const Printer& printer) {
    Vat v;
    v.slot = whole(r, "slot", 1, printer.tower.slots);
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

Resin read_resin(const std::string& name, Reader r) {
    Resin resin;
    resin.name = name;
    resin.exposure_s = positive(r, "exposure", Dimension::time, 1);
    resin.bottom_exposure_s = r.quantity("bottom_exposure", Dimension::time, resin.exposure_s);
    if (resin.bottom_exposure_s < resin.exposure_s) r.problem("bottom_exposure", "is shorter than exposure");
    resin.bottom_layers = r.has("bottom_layers") ? whole(r, "bottom_layers", 0, 10000) : 0;
    resin.cure_depth_um = length_um(r, "cure_depth", 1);
    resin.critical_share = r.number("critical_share", 0.8);
    if (!(resin.critical_share > 0 && resin.critical_share <= 1))
        r.problem("critical_share", "must be above 0, at most 1");
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
    p.pixel_um = positive(r, "pixel", Dimension::length, 1e6);
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

Cleaning read_cleaning(Reader r) {
    Cleaning c;
    c.spray_s = not_negative(r, "spray", Dimension::time);
    c.stroke_x_um = length_um(r, "stroke_x", 1);
    c.stroke_z_um = length_um(r, "stroke_z");
    c.speed_mm_s = speed(r, "speed");
    c.dry_s = not_negative(r, "dry", Dimension::time);
    c.brush = r.boolean("brush", false);
    r.finish();
    return c;
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

void read_axes(Reader r, Printer& printer) {
    for (const Axis axis : all_axes) {
        auto& spec = printer.axes[static_cast<std::size_t>(axis)];
        spec = read_axis(r.table(axis_name(axis)));
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
    within(Axis::carriage, p.carriage.print_um, "the print position");
    within(Axis::carriage, p.carriage.print_um + p.carriage.shear_um, "the shear stroke");
    within(Axis::carriage, p.carriage.tower_um, "the tower position");
    within(Axis::platform, 0, "the floor of the vat");
    within(Axis::platform, p.clear_um(p.platform.build_height_um) + p.cleaning.stroke_z_um,
           "the tallest part, lifted clear of the vat for cleaning,");
    within(Axis::tower, p.level_um(1) - p.hooks.travel_um, "slot 1, lowered,");
    within(Axis::tower, p.level_um(p.tower.slots), "the last slot");
}

void check_geometry(Reader& root, const Printer& p) {
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
    if (p.axis(Axis::platform).home_um() < p.clear_um(0)) {
        root.problem("axis.platform.home", "must end clear of the vat (home = \"max\")");
    }
}

Printer read_printer(Reader& root) {
    Printer p;
    p.name = root.text("name");
    if (root.has("layer_height")) p.layer_um = length_um(root, "layer_height", 1);
    p.controller = read_controller(root.table("controller"));
    read_axes(root.table("axis"), p);
    p.carriage = read_carriage(root.table("carriage"));
    p.platform = read_platform(root.table("platform"));
    p.tower = read_tower(root.table("tower"));
    Reader hooks = root.table("hooks");
    p.hooks = {length_um(hooks, "travel", 1), speed(hooks, "speed")};
    hooks.finish();
    p.vat_shape = read_vat_shape(root.table("vat_shape"));
    for (auto& [name, r] : root.named_tables("resin")) p.resins.push_back(read_resin(name, r));
    read_vats(root, p);
    p.projector = read_projector(root.table("projector"));
    p.cleaning = read_cleaning(root.table("cleaning"));
    p.pump = read_switch(root.table("pump", false));
    p.fans = read_switch(root.table("fans", false));
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
