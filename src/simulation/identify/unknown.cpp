#include "simulation/identify/unknown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/core/config_text.hpp"
#include "base/core/letters.hpp"
#include "base/core/parse_all.hpp"
#include "base/core/text.hpp"
#include "base/core/units.hpp"
#include "robot/description/cable_length.hpp"
#include "simulation/material/law_parameters.hpp"

namespace pliant::sim::identify {
namespace {

using config::path_part;

constexpr double unbounded = std::numeric_limits<double>::infinity();
/// Default bounds of positive numbers: this factor around the initial value.
constexpr double widest_factor = 1e6;
constexpr double least_share = 1e-9;  // of the size: nearer to 0 no robot is asked for
constexpr double least_poisson = -0.99, most_poisson = 0.4999;

struct Unit {
    std::string_view si;
    Dimension dimension;
    std::string_view shown;
    double factor;  ///< SI to `shown`
};
constexpr std::array<Unit, 7> units = {{
    {"Pa", Dimension::pressure, "kPa", 1e-3},
    {"m", Dimension::length, "mm", 1e3},
    {"m^3", Dimension::volume, "mm^3", 1e9},
    {"N", Dimension::force, "N", 1},
    {"N/m", Dimension::stiffness, "N/m", 1},
    {"kg/m^3", Dimension::density, "kg/m^3", 1},
    {"kg", Dimension::mass, "g", 1e3},
}};

const Unit* find_unit(std::string_view si) {
    const auto* const found = std::ranges::find(units, si, &Unit::si);
    return found == units.end() ? nullptr : found;
}

class Collector {
public:
    /// Above zero.
    void positive(std::string key, std::string unit, double value, double most = unbounded) {
        const bool known = value > 0;
        add({std::move(key), std::move(unit), value, known ? value / widest_factor : 0,
             known ? std::min(most, value * widest_factor) : most, Scale::log, 1});
    }
    /// Zero or above: dampings and frictions.
    void from_zero(std::string key, std::string unit, double value, double most = unbounded) {
        add({std::move(key), std::move(unit), value, 0, value > 0 ? std::min(most, value * widest_factor) : most,
             Scale::from_zero, value > 0 ? value : 1});
    }
    void any(std::string key, std::string unit, double value, double size) {
        add({std::move(key), std::move(unit), value, -unbounded, unbounded, Scale::linear, size});
    }
    void poisson(std::string key, double value) {
        add({std::move(key), "", value, least_poisson, std::max(most_poisson, value), Scale::poisson, 1});
    }
    std::vector<Unknown> all;

private:
    void add(Unknown unknown) { all.push_back(std::move(unknown)); }
};

/// mu and alpha of an Ogden law stand in lists, as mu.0 and alpha.0.
std::string key_of_constant(const std::string& name) {
    const std::size_t line = name.find('_');
    const bool numbered = name.starts_with("mu_") || name.starts_with("alpha_");
    if (!numbered) return name;
    return fmt::format("{}.{}", name.substr(0, line), std::stoi(name.substr(line + 1)) - 1);
}

void add_material(const robot::MaterialSpec& m, Collector& to) {
    const std::string owner = "material." + path_part(m.name) + ".";
    const bool two_moduli =
        std::ranges::any_of(material::parameters(m.law), [](const auto& p) { return p.name == "youngs_modulus"; });
    if (two_moduli) {
        to.positive(owner + "youngs_modulus", "Pa", m.youngs_modulus_Pa);
        to.poisson(owner + "poisson_ratio", m.poisson_ratio);
    } else {
        const double shear = material::moduli(m.law).shear_Pa;
        for (const auto& constant : material::parameters(m.law)) {
            const std::string key = owner + key_of_constant(constant.name);
            if (constant.name == "bulk_modulus") continue;
            if (constant.value > 0)
                to.positive(key, constant.unit, constant.value);
            else
                to.any(key, constant.unit, constant.value, constant.unit.empty() ? 1 : shear);
        }
        // A file that has one of them refuses the other.
        if (m.has_bulk_modulus)
            to.positive(owner + "bulk_modulus", "Pa", material::moduli(m.law).bulk_Pa);
        else
            to.poisson(owner + "poisson_ratio", m.poisson_ratio);
    }
    to.positive(owner + "density", "kg/m^3", m.density_kg_m3);
}

void add_cable(const robot::CableSpec& cable, Collector& to) {
    using Kind = robot::CableTarget::Kind;
    const std::string owner = "cable." + path_part(cable.name) + ".", target = owner + "target.";
    const robot::CableTarget& t = cable.target;
    const bool force = t.kind == Kind::tension_N;
    if (!cable.gap_elements) to.from_zero(owner + "friction", "", cable.friction, 10);
    const bool paid_out = robot::is_paid_out(t);
    if (t.kind == Kind::length_ratio)
        to.positive(target + "length_ratio", "", t.value, paid_out ? robot::target_limits(t.kind, false).high : 1);
    if (t.kind == Kind::shortening_m && paid_out)
        to.any(target + "shortening", "m", t.value, std::max(1e-3, -0.1 * t.value));
    else if (t.kind == Kind::shortening_m)
        to.positive(target + "shortening", "m", t.value);
    if (force) to.positive(target + "tension", "N", t.value);
    to.any(target + "offset", force ? "N" : "m", t.offset, force ? std::max(0.1, 0.1 * t.value) : 1e-3);
}

void add_chamber(const robot::ChamberSpec& chamber, Collector& to) {
    using Kind = robot::ChamberTarget::Kind;
    const std::string target = "chamber." + path_part(chamber.name) + ".target.";
    const robot::ChamberTarget& t = chamber.target;
    const double share = 0.1 * std::fabs(t.value);
    if (t.kind == Kind::volume_ratio) to.positive(target + "volume_ratio", "", t.value);
    if (t.kind == Kind::gas_ratio) to.positive(target + "gas_ratio", "", t.value);
    if (t.kind == Kind::volume_change_m3) to.any(target + "volume_change", "m^3", t.value, std::max(1e-7, share));
    if (t.kind == Kind::pressure_Pa) to.any(target + "pressure", "Pa", t.value, std::max(1e3, share));
    if (t.kind == Kind::gas_ratio) return;
    const bool pressure = t.kind == Kind::pressure_Pa;
    to.any(target + "offset", pressure ? "Pa" : "m^3", t.offset, pressure ? std::max(1e3, share) : 1e-7);
}

/// In length units: the free length of a spring for which the file gives none.
double drawn_length(const robot::SpringSpec& spring) {
    double length = 0;
    for (std::size_t k = 1; k < spring.points.size(); ++k) length += norm(spring.points[k] - spring.points[k - 1]);
    return length;
}

void add_contact(const robot::Robot& robot, Collector& to) {
    if (robot.contact) {
        to.from_zero("contact.friction", "", robot.contact->friction, 10);
        if (robot.contact->stiffness_Pa) to.positive("contact.stiffness", "Pa", *robot.contact->stiffness_Pa);
    }
    for (const auto& obstacle : robot.obstacles)
        to.from_zero("obstacle." + path_part(obstacle.name) + ".friction", "", obstacle.friction, 10);
}

void add_masses(const robot::Robot& robot, Collector& to) {
    for (const auto& object : robot.objects) {
        const std::string owner = "object." + path_part(object.name) + ".";
        if (object.mass_kg > 0) to.positive(owner + "mass", "kg", object.mass_kg);
        if (object.density_kg_m3 > 0) to.positive(owner + "density", "kg/m^3", object.density_kg_m3);
        to.from_zero(owner + "friction", "", object.friction, 10);
    }
    for (const auto& mass : robot.masses) to.positive("mass." + path_part(mass.name) + ".mass", "kg", mass.mass_kg);
}

/// One end of "LOW..HIGH".
Result<double> read_bound(const Unknown& unknown, std::string_view text) {
    text = trimmed(text);
    const Unit* unit = find_unit(unknown.unit);
    if (unit != nullptr) {
        Result<double> value = parse_quantity(text, unit->dimension);
        if (!value) return input_error("{}: {}", unknown.key, value.error().message);
        return value;
    }
    double value = 0;
    if (parse_all(text, value) && std::isfinite(value)) return value;
    return input_error("{}: \"{}\" is not a number", unknown.key, text.substr(0, 40));
}

Status take_bounds(Unknown& unknown, std::string_view text) {
    const std::size_t dots = text.find("..");
    if (dots == std::string_view::npos)
        return input_error("{}: \"{}\" is not a range; write LOW..HIGH, as in {}", unknown.key, text.substr(0, 40),
                           find_unit(unknown.unit) != nullptr
                               ? fmt::format("\"1 {0}..2 {0}\"", find_unit(unknown.unit)->shown)
                               : "0.1..0.4");
    const Result<double> low = read_bound(unknown, text.substr(0, dots));
    if (!low) return tl::unexpected(low.error());
    const Result<double> high = read_bound(unknown, text.substr(dots + 2));
    if (!high) return tl::unexpected(high.error());
    if (!(*low < *high))
        return input_error("{}: the range from {} to {} is empty; LOW must be below HIGH", unknown.key,
                           unknown.shown(*low), unknown.shown(*high));
    if (unknown.scale == Scale::log && !(*low >= 0))
        return input_error("{}: {} is not possible; it is above zero", unknown.key, unknown.shown(*low));
    if (unknown.scale == Scale::from_zero && !(*low >= 0))
        return input_error("{}: {} is not possible; it is zero or above", unknown.key, unknown.shown(*low));
    if (unknown.scale == Scale::poisson && !(*low > -1 && *high < 0.5))
        return input_error("{}: Poisson's ratio is above -1 and below 0.5", unknown.key);
    unknown.low = unknown.scale == Scale::log ? std::max(*low, *high / widest_factor) : *low;
    unknown.high = *high;
    const bool needs_more = unknown.scale == Scale::log || unknown.scale == Scale::from_zero;
    if (unknown.value >= *low && unknown.value <= *high && (!needs_more || unknown.value > 0)) return {};
    if (unknown.scale == Scale::from_zero) unknown.size = *low > 0 ? std::sqrt(*low * *high) : 0.1 * *high;
    if (unknown.scale == Scale::from_zero && *low > 0) {
        unknown.value = unknown.size;
        return {};
    }
    unknown.value = unknown.value_at(0.5 * (unknown.coordinate(unknown.low) + unknown.coordinate(unknown.high)));
    return {};
}

}  // namespace

double Unknown::coordinate(double of_value) const {
    if (scale == Scale::linear) return of_value / size;
    if (scale == Scale::from_zero) return std::asinh(of_value / size);
    return scale == Scale::log ? std::log(of_value) : -std::log1p(-2 * of_value);
}

double Unknown::value_at(double u) const {
    if (scale == Scale::linear) return size * u;
    if (scale == Scale::from_zero) return size * std::max(std::sinh(u), least_share);
    return scale == Scale::log ? std::exp(u) : -0.5 * std::expm1(-u);
}

double Unknown::rate(double of_value) const {
    if (scale == Scale::linear) return size;
    if (scale == Scale::from_zero) return std::hypot(size, of_value);
    return scale == Scale::log ? of_value : 0.5 - of_value;
}

std::string Unknown::assignment(double of_value) const {
    if (unit.empty()) return fmt::format("{}={:.17g}", key, of_value);
    return fmt::format("{}=\"{:.17g} {}\"", key, of_value, unit);
}

std::string Unknown::shown(double of_value) const {
    const Unit* found = find_unit(unit);
    if (found == nullptr) return fmt::format("{:.5g}", of_value);
    if (found->dimension == Dimension::pressure && std::fabs(of_value) > 999999.9)
        return fmt::format("{:.5g} MPa", 1e-6 * of_value);
    return fmt::format("{:.5g} {}", found->factor * of_value, found->shown);
}

std::vector<Unknown> possible_unknowns(const robot::Robot& robot) {
    Collector to;
    for (const auto& material : robot.materials) add_material(material, to);
    for (const auto& cable : robot.cables) add_cable(cable, to);
    for (const auto& chamber : robot.chambers) add_chamber(chamber, to);
    for (const auto& spring : robot.springs) {
        to.positive("spring." + path_part(spring.name) + ".stiffness", "N/m", spring.stiffness_N_m);
        to.positive("spring." + path_part(spring.name) + ".free_length", "m",
                    robot.unit_m * spring.free_length.value_or(drawn_length(spring)));
    }
    for (const auto& load : robot.loads) {
        if (load.pressure_Pa) {
            to.any("load." + path_part(load.name) + ".pressure", "Pa", *load.pressure_Pa,
                   std::max(1e3, 0.1 * std::fabs(*load.pressure_Pa)));
            continue;
        }
        if (load.force_N == Vec3{} && !(load.torque_Nm == Vec3{})) continue;  // the file need not have the key
        for (std::size_t axis = 0; axis < 3; ++axis)
            to.any(fmt::format("load.{}.force.{}", path_part(load.name), axis), "N", load.force_N[axis],
                   std::max(0.1, 0.1 * std::fabs(load.force_N[axis])));
    }
    add_contact(robot, to);
    add_masses(robot, to);
    if (robot.program.dynamics) {
        to.from_zero("program.mass_damping", "", robot.program.dynamics->damping.mass_per_s);
        to.from_zero("program.stiffness_damping", "", robot.program.dynamics->damping.stiffness_s);
    }
    return std::move(to.all);
}

Result<Unknown> find_unknown(const robot::Robot& robot, std::string_view text) {
    const std::string_view key = trimmed(text.substr(0, text.find('=')));
    const std::vector<Unknown> all = possible_unknowns(robot);
    const auto found = std::ranges::find(all, key, &Unknown::key);
    if (found == all.end()) {
        std::vector<std::string> names;
        for (const Unknown& one : all) names.push_back(one.key);
        const std::string nearest = nearest_name(key, names);
        return input_error("{}: the robot has no such parameter to find; {}",
                           key.empty() ? fmt::format("--unknown \"{}\"", text) : std::string(key),
                           nearest.empty() ? "it has " + join_names(names) : "did you mean \"" + nearest + "\"?");
    }
    Unknown unknown = *found;
    if (key.size() < text.size() && text.find('=') != std::string_view::npos) {
        if (Status status = take_bounds(unknown, text.substr(text.find('=') + 1)); !status)
            return tl::unexpected(status.error());
    }
    if ((unknown.scale == Scale::log || unknown.scale == Scale::from_zero) && !(unknown.value > 0))
        return input_error(
            "{0}: is 0 in the robot file, where nothing tells how to change it; set another value there to begin "
            "with, or give a range, {0}=LOW..HIGH",
            unknown.key);
    return unknown;
}

Result<std::vector<Unknown>> find_unknowns(const robot::Robot& robot, const std::vector<std::string>& texts) {
    std::vector<Unknown> found;
    for (const std::string& text : texts) {
        Result<Unknown> unknown = find_unknown(robot, text);
        if (!unknown) return tl::unexpected(unknown.error());
        found.push_back(std::move(*unknown));
    }
    return found;
}

}  // namespace pliant::sim::identify
