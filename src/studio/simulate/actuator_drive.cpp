#include "studio/simulate/actuator_drive.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/core/text.hpp"
#include "presentation/report/units.hpp"

namespace pliant::studio {
namespace {

using Kind = sim::Drive::Kind;

/// A length or volume is none if it is less than this share of that at rest.
constexpr double rounding = 1e-9;

/// The thesis' elements support lengths and volumes only.
bool is_by_elements(const sim::Model& model, std::size_t actuator) {
    return std::ranges::any_of(model.description().growths, [&](const sim::Growth& growth) {
        return growth.actuator == static_cast<int>(actuator);
    });
}

tl::unexpected<Error> no_such_kind(const ActuatorValue& value, const char* kinds) {
    return input_error("\"{}\" has no {}; it is driven by {}", value.name, value.kind, kinds);
}

tl::unexpected<Error> out_of_range(const ActuatorValue& value, const std::string& range) {
    return input_error("\"{}\": {} is {:g}; it must be {}", value.name, value.kind, value.value, range);
}

Result<ActuatorDrive> cable_drive(const sim::Model& model, std::size_t cable, double rest, const ActuatorValue& value) {
    const double v = value.value;
    const auto drive = [&](Kind kind, double target) { return ActuatorDrive{cable, {kind, target}}; };
    const bool by_elements = is_by_elements(model, cable);
    if (value.kind == "length_ratio")
        return v > 0 ? Result<ActuatorDrive>(drive(Kind::measure, v * rest)) : out_of_range(value, "over 0");
    if (value.kind == "shortening_mm") {
        if (!(v / report::mm_per_m < (1 - rounding) * rest))
            return out_of_range(value, fmt::format("under {:g}, the length at rest", report::mm_per_m * rest));
        return drive(Kind::measure, rest - v / report::mm_per_m);
    }
    if (value.kind != "tension_N" || by_elements)
        return no_such_kind(
            value, by_elements ? "length_ratio and shortening_mm" : "length_ratio, shortening_mm and tension_N");
    if (v < 0) return out_of_range(value, "at least 0: a cable cannot push");
    return drive(Kind::multiplier, v);
}

Result<ActuatorDrive> chamber_drive(const sim::Model& model, std::size_t actuator, double rest,
                                    const ActuatorValue& value) {
    const double v = value.value;
    const bool by_elements = is_by_elements(model, actuator);
    const auto drive = [&](Kind kind, double target) { return ActuatorDrive{actuator, {kind, target}}; };
    if (value.kind == "volume_ratio")
        return v > 0 ? Result<ActuatorDrive>(drive(Kind::measure, v * rest)) : out_of_range(value, "over 0");
    if (value.kind == "volume_change_mm3") {
        constexpr double m3 = 1e-9;  // of a mm3
        if (!(rest + m3 * v > rounding * rest))
            return out_of_range(value, fmt::format("over {:g}, the chamber empty", -rest / m3));
        return drive(Kind::measure, rest + m3 * v);
    }
    const bool has_gas = !by_elements;
    if (value.kind == "pressure_kPa" && has_gas) return drive(Kind::multiplier, 0 - 1e3 * v);
    if (value.kind != "gas_ratio" || !has_gas)
        return no_such_kind(value, has_gas ? "volume_ratio, volume_change_mm3, pressure_kPa and gas_ratio"
                                           : "volume_ratio and volume_change_mm3");
    if (!(v > 0)) return out_of_range(value, "over 0");
    return drive(Kind::gas, v * model.description().ambient_pressure_Pa * rest);
}

}  // namespace

std::string no_such_part(const char* part, const std::string& name, std::vector<std::string> names) {
    for (std::string& one : names) one = "\"" + one + "\"";
    return fmt::format("there is no {} \"{}\"; the robot has {}", part, name,
                       names.empty() ? "none" : join_names(names));
}

Result<ActuatorDrive> drive_of(const sim::Model& model, const std::vector<double>& rest_measures,
                               const ActuatorValue& value) {
    const sim::Description& d = model.description();
    const auto named = [&](const auto& actuator) { return actuator.name == value.name; };
    if (const auto cable = std::ranges::find_if(d.cables, named); cable != d.cables.end()) {
        const auto c = static_cast<std::size_t>(cable - d.cables.begin());
        return cable_drive(model, c, rest_measures[c], value);
    }
    if (const auto chamber = std::ranges::find_if(d.chambers, named); chamber != d.chambers.end()) {
        const std::size_t a = d.cables.size() + static_cast<std::size_t>(chamber - d.chambers.begin());
        return chamber_drive(model, a, rest_measures[a], value);
    }
    std::vector<std::string> names;
    for (const auto& cable : d.cables) names.push_back(cable.name);
    for (const auto& chamber : d.chambers) names.push_back(chamber.name);
    return input_error("{}", no_such_part("actuator", value.name, std::move(names)));
}

}  // namespace pliant::studio
