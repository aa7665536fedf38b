#include "base/core/units.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <span>

#include "base/core/parse_all.hpp"

namespace pliant {
namespace {

struct Unit {
    std::string_view name;
    double factor;
};

constexpr Unit length_units[] = {{"mm", 1e-3}, {"m", 1}, {"cm", 1e-2}, {"um", 1e-6}, {"µm", 1e-6}, {"in", 0.0254}};
constexpr Unit time_units[] = {{"s", 1}, {"ms", 1e-3}, {"min", 60}, {"h", 3600}};
constexpr Unit mass_units[] = {{"kg", 1}, {"g", 1e-3}};
constexpr Unit force_units[] = {{"N", 1}, {"mN", 1e-3}, {"kN", 1e3}};
constexpr Unit pressure_units[] = {{"MPa", 1e6}, {"kPa", 1e3},  {"Pa", 1},           {"GPa", 1e9},
                                   {"bar", 1e5}, {"mbar", 100}, {"psi", 6894.757293}};
constexpr Unit density_units[] = {{"kg/m^3", 1}, {"g/cm^3", 1e3}};
constexpr Unit speed_units[] = {{"mm/s", 1e-3}, {"m/s", 1}, {"mm/min", 1e-3 / 60}, {"in/s", 0.0254}, {"cm/s", 1e-2}};
constexpr Unit acceleration_units[] = {{"mm/s^2", 1e-3}, {"m/s^2", 1}};
constexpr Unit volume_units[] = {{"ml", 1e-6}, {"mm^3", 1e-9},         {"cm^3", 1e-6},
                                 {"l", 1e-3},  {"in^3", 16.387064e-6}, {"m^3", 1}};
constexpr Unit angle_units[] = {{"deg", std::numbers::pi / 180}, {"rad", 1}};
constexpr Unit irradiance_units[] = {{"mW/cm^2", 10}, {"W/m^2", 1}};
constexpr Unit angular_speed_units[] = {{"deg/s", std::numbers::pi / 180}, {"rad/s", 1}};
constexpr Unit angular_acceleration_units[] = {{"deg/s^2", std::numbers::pi / 180}, {"rad/s^2", 1}};
constexpr Unit dose_units[] = {{"mJ/cm^2", 10}, {"J/m^2", 1}};

constexpr Unit stiffness_units[] = {{"N/mm", 1e3}, {"N/m", 1}, {"mN/mm", 1}};
constexpr Unit inertia_units[] = {{"kg m^2", 1}, {"g mm^2", 1e-9}, {"kg mm^2", 1e-6}, {"g cm^2", 1e-7}};
constexpr Unit torque_units[] = {{"N mm", 1e-3}, {"N m", 1}, {"mN m", 1e-3}, {"mN mm", 1e-6}};
constexpr double per_degree = 180 / std::numbers::pi;
constexpr Unit torsional_stiffness_units[] = {
    {"N mm/rad", 1e-3}, {"N m/rad", 1}, {"N mm/deg", 1e-3 * per_degree}, {"N m/deg", per_degree}};

struct DimensionInfo {
    std::string_view text;
    std::span<const Unit> units;
};

DimensionInfo info(Dimension dimension) {
    switch (dimension) {
        case Dimension::length:
            return {"a length such as \"2.5 mm\"", length_units};
        case Dimension::time:
            return {"a time such as \"15 s\"", time_units};
        case Dimension::mass:
            return {"a mass such as \"30 g\"", mass_units};
        case Dimension::force:
            return {"a force such as \"0.06 N\"", force_units};
        case Dimension::pressure:
            return {"a pressure such as \"12 MPa\"", pressure_units};
        case Dimension::density:
            return {"a density such as \"1040 kg/m^3\"", density_units};
        case Dimension::speed:
            return {"a speed such as \"25 mm/s\"", speed_units};
        case Dimension::acceleration:
            return {"an acceleration such as \"200 mm/s^2\"", acceleration_units};
        case Dimension::volume:
            return {"a volume such as \"500 ml\"", volume_units};
        case Dimension::angle:
            return {"an angle such as \"90 deg\"", angle_units};
        case Dimension::irradiance:
            return {"an irradiance such as \"5 mW/cm^2\"", irradiance_units};
        case Dimension::angular_speed:
            return {"an angular speed such as \"36 deg/s\"", angular_speed_units};
        case Dimension::angular_acceleration:
            return {"an angular acceleration such as \"90 deg/s^2\"", angular_acceleration_units};
        case Dimension::dose:
            return {"a dose of light such as \"8 mJ/cm^2\"", dose_units};
        case Dimension::stiffness:
            return {"a stiffness such as \"0.5 N/mm\"", stiffness_units};
        case Dimension::inertia:
            return {"a moment of inertia such as \"40 g mm^2\"", inertia_units};
        case Dimension::torque:
            return {"a torque such as \"15 N mm\"", torque_units};
        case Dimension::torsional_stiffness:
            return {"a torsional stiffness such as \"15 N mm/rad\"", torsional_stiffness_units};
    }
    return {"", {}};
}

/// Keyboards have the Greek letter mu, U+03BC, beside the sign of micro, U+00B5.
std::string with_micro_sign(std::string text) {
    constexpr std::string_view letter = "\xCE\xBC", sign = "\xC2\xB5";
    for (std::size_t at = text.find(letter); at != std::string::npos; at = text.find(letter, at))
        text.replace(at, letter.size(), sign);
    return text;
}

/// Converts "N*mm" and "N * mm" to "N mm".
std::string with_spaces(std::string_view unit) {
    std::string text;
    for (const char c : unit) {
        if (c != '*' && c != ' ') {
            text += c;
        } else if (!text.ends_with(' ')) {
            text += ' ';
        }
    }
    return text;
}

std::string_view trim(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
    return text;
}

}  // namespace

std::string_view describe(Dimension dimension) {
    return info(dimension).text;
}

Result<double> unit_factor(std::string_view unit, Dimension dimension) {
    const DimensionInfo known = info(dimension);
    const std::string wanted = with_micro_sign(with_spaces(unit));
    std::string names;
    for (const Unit& u : known.units) {
        if (u.name == wanted) return u.factor;
        names += (names.empty() ? "" : ", ") + std::string(u.name);
    }
    return input_error("unknown unit \"{}\"; here the units are {}", unit, names);
}

Result<double> parse_quantity(std::string_view text, Dimension dimension) {
    const std::string_view trimmed = trim(text);
    const char* first = without_plus(trimmed).data();
    const char* last = trimmed.data() + trimmed.size();
    double value = 0;
    const auto [end, code] = std::from_chars(first, last, value);
    if (code != std::errc() || !std::isfinite(value)) {
        return input_error("\"{}\" is not {}", text, describe(dimension));
    }
    const std::string_view unit = trim(std::string_view(end, static_cast<std::size_t>(last - end)));
    if (unit.empty()) return input_error("\"{}\" has no unit; write {}", text, describe(dimension));
    if (unit.size() > 1 && unit[0] == ',' && unit[1] >= '0' && unit[1] <= '9') {
        std::string pointed(trimmed);
        pointed[static_cast<std::size_t>(unit.data() - trimmed.data())] = '.';
        return input_error("\"{}\" has a decimal comma; write a point: \"{}\"", text, pointed);
    }
    const Result<double> factor = unit_factor(unit, dimension);
    if (!factor) return factor;
    if (!std::isfinite(value * *factor)) return input_error("\"{}\" is too large", text);
    return value * *factor;
}

bool is_unit(std::string_view unit) {
    for (int k = 0; k <= static_cast<int>(Dimension::torsional_stiffness); ++k) {
        if (unit_factor(unit, static_cast<Dimension>(k))) return true;
    }
    return false;
}

}  // namespace pliant
