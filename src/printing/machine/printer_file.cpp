// From TOML to a Printer: one function per table, then checks across tables.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "base/core/config.hpp"
#include "base/core/letters.hpp"
#include "printing/job/exposure.hpp"
#include "printing/machine/gcode.hpp"
#include "printing/machine/printer.hpp"
#include "printing/machine/printer_reading.hpp"
#include "printing/machine/switches.hpp"

namespace pliant::machine {
namespace {

using config::Problems;
using config::Reader;
using namespace reading;

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

/// Speeds, acceleration, and homing.
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

/// Steps per mm are computed from what can be counted on the machine.
Drive read_drive(Reader& r, bool rotary) {
    Drive d;
    if (r.has("motors")) d.motors = r.whole("motors", 1, 2);
    if (r.has("motor_steps")) d.motor_steps = r.whole("motor_steps", 1, 10000);
    if (r.has("microsteps")) d.microsteps = r.whole("microsteps", 1, 256);
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
    c.baud_rate = r.whole("baud_rate", 9600, 1000000);
    c.window_lines = r.whole("window_lines", 1, 4, c.window_lines);
    c.window_bytes = r.whole("window_bytes", 96, 4096, c.window_bytes);
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
    p.settle_s = wait_s(r, "settle");
    r.finish();
    return p;
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
    v.slot = r.whole("slot", 1, printer.slot_count());
    v.resin = r.text("resin", "");
    v.fill_ml = not_negative(r, "fill", Dimension::volume, 1e6);
    if (v.fill_ml > printer.vat_shape.free_volume_ml) {
        r.problem("fill", fmt::format("overflows once the platform is in; at most {:.0f} ml",
                                      printer.vat_shape.free_volume_ml));
    }
    if (!v.resin.empty() && v.fill_ml >= 0 && v.fill_ml <= printer.vat_shape.least_ml)
        r.problem("fill", fmt::format("gives no resin: more than {:g} ml must be in the vat (vat_shape.least)",
                                      printer.vat_shape.least_ml));
    if (printer.vat_of_slot(v.slot) != nullptr) r.problem("slot", fmt::format("{} holds a vat already", v.slot));
    if (!v.resin.empty() && printer.find_resin(v.resin) == nullptr) {
        r.problem("resin", fmt::format("\"{}\" has no [resin.{}] table", v.resin, v.resin));
    }
    r.finish();
    return v;
}

/// Keys that were not asked for, because they are missing, are known nevertheless.
void know(Reader& r, std::initializer_list<const char*> keys) {
    for (const char* key : keys) {
        if (!r.has(key)) (void)r.number(key, 0.0);
    }
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
        r.has("elephant_foot_layers") ? r.whole("elephant_foot_layers", 1, 10000) : std::max(1, resin.bottom_layers);
}

Resin read_resin(const std::string& name, Reader r) {
    Resin resin;
    resin.name = name;
    resin.exposure_s = positive(r, "exposure", Dimension::time, 1);
    if (resin.exposure_s > 0 && resin.exposure_s < job::shortest_exposure_s)
        r.problem("exposure", "must be at least a millisecond");
    resin.bottom_exposure_s = r.quantity("bottom_exposure", Dimension::time, resin.exposure_s);
    if (resin.bottom_exposure_s < resin.exposure_s) r.problem("bottom_exposure", "is shorter than exposure");
    resin.bottom_layers = r.has("bottom_layers") ? r.whole("bottom_layers", 0, 10000) : 0;
    resin.transition_layers = r.has("transition_layers") ? r.whole("transition_layers", 0, 10000) : 0;
    read_outline_offsets(r, resin);
    resin.cure_depth_um = length_um(r, "cure_depth", 1);
    resin.critical_share = r.number("critical_share", 0.8);
    if (!(resin.critical_share > 0 && resin.critical_share <= 1))
        r.problem("critical_share", "must be above 0, at most 1");
    if (r.has("penetration_depth") != r.has("critical_dose")) {
        r.problem("penetration_depth", "and critical_dose go together: they are the working curve");
        (void)r.quantity("penetration_depth", Dimension::length, 0);
        (void)r.quantity("critical_dose", Dimension::dose, 0);
    } else if (r.has("penetration_depth")) {
        resin.penetration_um = positive(r, "penetration_depth", Dimension::length, 1e6);
        resin.critical_J_m2 = positive(r, "critical_dose", Dimension::dose, 1);
    }
    know(r, {"bottom_layers", "transition_layers", "xy_compensation", "bleed_compensation", "elephant_foot",
             "elephant_foot_layers", "penetration_depth", "critical_dose"});
    r.finish();
    return resin;
}

/// Light at evenly spaced coverages: starting at 0, non-decreasing, at most 1.
std::vector<double> read_grey(Reader& r) {
    if (!r.has("grey")) return {};
    std::vector<double> grey = r.numbers("grey");
    const bool good = grey.size() >= 2 && grey.size() <= 256 && grey.front() == 0 && grey.back() <= 1 &&
                      std::is_sorted(grey.begin(), grey.end()) && grey.back() > 0;
    if (!good)
        r.problem("grey", "must be 2 to 256 numbers that begin with 0, never fall, and end above 0, at most at 1");
    return grey;
}

/// Alignment of the image on the platform, without mirroring.
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
    p.width_px = r.whole("width", 1, 32768);
    p.height_px = r.whole("height", 1, 32768);
    constexpr double parts = 1e6;  // of a micrometre; the remainder is rounding of "100 um" to metres
    p.pixel_um = std::round(parts * r.quantity("pixel", Dimension::length) * 1e6) / parts;
    constexpr double least_um = 0.1, most_um = 10'000;
    if (r.has("pixel") && !(p.pixel_um >= least_um && p.pixel_um <= most_um))
        r.problem("pixel", "must be 0.1 um to 10 mm");
    p.mirror_x = r.boolean("mirror_x", false);
    p.mirror_y = r.boolean("mirror_y", false);
    read_alignment(r, p);
    p.grey = read_grey(r);
    p.mask = r.text("mask", "");
    if (r.has("irradiance")) p.irradiance_W_m2 = positive(r, "irradiance", Dimension::irradiance, 1);
    p.delay_s = wait_s(r, "delay");
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

/// The set of axes follows from the kind of store.
void read_axes(Reader r, Printer& printer, const StoreTables& has) {
    const auto name = [&](Axis axis) { return axis_name(axis, has.names()); };
    for (const Axis axis : all_axes) {
        const bool on_table = has.table || has.wall;
        const bool wanted = axis == Axis::platform || (axis == Axis::table ? on_table : has.carriage());
        if (!wanted) {
            if (r.has(name(axis))) {
                r.problem(name(axis), fmt::format("needs a [{}] table", axis == Axis::table ? "table" : "tower"));
            }
            continue;
        }
        auto& spec = printer.axes[static_cast<std::size_t>(axis)];
        spec = read_axis(r.table(name(axis)), printer.controller.dialect, axis == Axis::table && !has.wall);
        for (const Axis other : all_axes) {
            if (other < axis && printer.axis(other).letter == spec.letter && spec.letter != '?') {
                r.problem(name(axis), fmt::format("has the letter of the {} axis", name(other)));
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

/// Resins in a cleaning pair must exist, so that misspelt names are noticed.
void check_pairs(Reader& root, const Printer& p) {
    const auto& pairs = p.cleaning.pairs;
    for (auto pair = pairs.begin(); pair != pairs.end(); ++pair) {
        if (std::any_of(pairs.begin(), pair,
                        [&](const CleaningPair& other) { return other.from == pair->from && other.to == pair->to; }))
            root.problem("cleaning.pair", fmt::format("from \"{}\" to \"{}\" is there twice", pair->from, pair->to));
        for (const std::string& resin : {pair->from, pair->to}) {
            if (p.find_resin(resin) != nullptr) continue;
            root.problem("cleaning.pair",
                         fmt::format("names resin \"{}\", which has no [resin.{}] table", resin, resin));
        }
    }
}

/// Layers are whole micrometres high: rounding would change the height of the part.
int read_layer_um(Reader& root) {
    const double wanted_um = 1e6 * root.quantity("layer_height", Dimension::length);
    const int layer_um = length_um(root, "layer_height", 1);
    if (std::abs(wanted_um - layer_um) > 1e-6 * wanted_um)
        root.problem("layer_height", fmt::format("is {:.6g} um; a layer is a whole number of micrometres", wanted_um));
    return layer_um;
}

/// A dose follows from the irradiance.
void check_curves(Reader& root, const Printer& p) {
    for (const Resin& resin : p.resins) {
        if (resin.penetration_um > 0 && !(p.projector.irradiance_W_m2 > 0))
            root.problem(fmt::format("resin.{}", resin.name),
                         "penetration_depth and critical_dose need projector.irradiance: the dose follows from it");
    }
}

/// What the machine refuses to do must not be asked of it by other keys.
void check_limits(Reader& root, const Printer& p) {
    for (const Resin& resin : p.resins) {
        const double longest_s = std::max(resin.exposure_s, resin.bottom_exposure_s);
        if (longest_s > p.limits.exposure_s)
            root.problem(
                fmt::format("resin.{}", resin.name),
                fmt::format("exposes for {:g} s, longer than limits.exposure, {:g} s", longest_s, p.limits.exposure_s));
    }
    double spray_s = p.cleaning.spray_s;
    for (const CleaningPair& pair : p.cleaning.pairs) spray_s = std::max(spray_s, pair.spray_s);
    if (spray_s > p.limits.cleaning_s)
        root.problem("cleaning", fmt::format("cleans for {:g} s, longer than limits.cleaning, {:g} s", spray_s,
                                             p.limits.cleaning_s));
}

Printer read_printer(Reader& root, const StoreTables& has) {
    Printer p;
    p.name = root.text("name");
    if (std::any_of(p.name.begin(), p.name.end(), is_control))
        root.problem("name", "must have no line breaks or other control characters");
    if (root.has("layer_height")) p.layer_um = read_layer_um(root);
    p.controller = read_controller(root.table("controller"));
    read_axes(root.table("axis"), p, has);
    p.platform = read_platform(root.table("platform"));
    read_store(root, p, has);
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
    read_switches(root, p);
    p.limits = read_limits(root.table("limits", false));
    root.finish();
    return p;
}

Result<Printer> from_document(const config::Document& document) {
    Problems problems(document.file.string());
    Reader root(document.root, problems);
    const StoreTables has = store_tables(root);
    if (auto status = problems.status(); !status) return tl::unexpected(status.error());
    Printer printer = read_printer(root, has);
    if (problems.empty()) {
        check_store(root, printer);
        check_magnet(root, printer);
        check_pairs(root, printer);
        check_curves(root, printer);
        check_limits(root, printer);
        check_switches(root, printer);
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
