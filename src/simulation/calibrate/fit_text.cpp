// Output of a fit: text, robot file and JSON.
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/core/config_text.hpp"
#include "base/core/json.hpp"
#include "simulation/calibrate/fit.hpp"

namespace pliant::calibrate {
namespace {

std::string pressure(double value_Pa) {
    const double size = std::fabs(value_Pa);
    if (size >= 1e5) return fmt::format("{:.5g} MPa", value_Pa / 1e6);
    if (size >= 100) return fmt::format("{:.5g} kPa", value_Pa / 1e3);
    return fmt::format("{:.5g} Pa", value_Pa);
}

std::string join(const std::vector<std::string>& list) {
    std::string text;
    for (const std::string& entry : list) text += (text.empty() ? "" : ", ") + entry;
    return text;
}

/// Young's modulus of the material with its Poisson's ratio, whose shear modulus is the fitted one, a third of that of
/// the incompressible fit; empty for laws with other constants.
std::optional<double> modulus_of_material(const Fit& fit) {
    const auto modulus = std::ranges::find(fit.constants, "youngs_modulus", &Constant::name);
    if (modulus == fit.constants.end()) return std::nullopt;
    return modulus->value * 2 * (1 + fit.poisson_ratio) / 3;
}

}  // namespace

std::string material_toml(const Fit& fit, const std::string& name) {
    std::string text = fmt::format("[material.{}]\nlaw = \"{}\"\n", config::key_text(name), material::name(fit.law));
    std::vector<std::string> mu;
    std::vector<std::string> alpha;
    for (const Constant& c : fit.constants) {
        if (c.name == "mu")
            mu.push_back("\"" + pressure(c.value) + "\"");
        else if (c.name == "alpha")
            alpha.push_back(fmt::format("{:.6g}", c.value));
        else if (c.name == "youngs_modulus")
            text += fmt::format("{} = \"{}\"\n", c.name, pressure(*modulus_of_material(fit)));
        else
            text += fmt::format("{} = \"{}\"\n", c.name, pressure(c.value));
    }
    if (!mu.empty()) text += fmt::format("mu = [{}]\nalpha = [{}]\n", join(mu), join(alpha));
    return text + fmt::format("poisson_ratio = {:.6g}\n", fit.poisson_ratio);
}

std::string fit_text(const Fit& fit) {
    std::string text = fmt::format("{}, {} rows: R^2 {:.5f}, rms error {}\n", material::name(fit.law),
                                   fit.stress_Pa.size(), fit.r_squared, pressure(fit.rms_error_Pa));
    for (const Constant& c : fit.constants) {
        const std::string value = c.is_pressure ? pressure(c.value) : fmt::format("{:.5g}", c.value);
        const std::string half = c.is_pressure ? pressure(c.half_width) : fmt::format("{:.3g}", c.half_width);
        text += fmt::format("  {:<15} {:>13}  {}\n", c.name, value,
                            std::isfinite(c.half_width) ? "+- " + half + " (95 %)" : "(no interval)");
    }
    if (const auto modulus = modulus_of_material(fit))
        text += fmt::format(
            "  youngs_modulus is that of the incompressible fit, 3 mu; the material below has 2 mu (1 + "
            "poisson_ratio), {}\n",
            pressure(*modulus));
    for (const std::string& warning : fit.warnings) text += "  warning: " + warning + "\n";
    return text;
}

std::string fit_json(const Fit& fit, const TensileTest& test) {
    nlohmann::ordered_json json;
    json["law"] = material::name(fit.law);
    json["constants"] = nlohmann::ordered_json::array();
    for (const Constant& c : fit.constants) {
        nlohmann::ordered_json one = {
            {"name", c.name}, {"unit", c.is_pressure ? "Pa" : "1"}, {"value", c.value}, {"confidence_95", nullptr}};
        if (std::isfinite(c.half_width)) one["confidence_95"] = {c.value - c.half_width, c.value + c.half_width};
        json["constants"].push_back(std::move(one));
    }
    if (const auto modulus = modulus_of_material(fit))
        json["material"] = {{"youngs_modulus_Pa", *modulus}, {"poisson_ratio", fit.poisson_ratio}};
    json["r_squared"] = fit.r_squared;
    json["rms_error_Pa"] = fit.rms_error_Pa;
    json["warnings"] = fit.warnings;
    json["stretch"] = test.stretch;
    json["stress_Pa"] = test.stress_Pa;
    json["fitted_stress_Pa"] = fit.stress_Pa;
    return json_text(json, 2);
}

}  // namespace pliant::calibrate
