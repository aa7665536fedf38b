#include "printing/prepare/exposures.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/core/units.hpp"
#include "printing/job/exposure.hpp"
#include "printing/machine/working_curve.hpp"
#include "printing/prepare/option_text.hpp"

namespace pliant::prepare {
namespace {

/// Whole milliseconds, as in G-code, so that the manifest says what the program does.
double rounded_s(double seconds) {
    return std::round(seconds * 1000) / 1000;
}

int most_bottom_layers(const machine::Printer& printer) {
    int most = 0;
    for (const machine::Resin& resin : printer.resins) most = std::max(most, resin.bottom_layers);
    return most;
}

/// A material with the printer file's settings for its resin; for an unknown resin, the longest exposures in the file,
/// and the most bottom layers.
job::Material with_exposure(const std::string& name, const std::string& resin, const machine::Printer& printer,
                            std::vector<std::string>& warnings) {
    job::Material entry;
    entry.name = name;
    entry.resin = resin;
    if (const machine::Resin* known = printer.find_resin(resin)) {
        entry.exposure_s = known->exposure_s;
        entry.bottom_exposure_s = known->bottom_exposure_s;
        entry.bottom_layers = known->bottom_layers;
        return entry;
    }
    for (const machine::Resin& other : printer.resins) {
        entry.exposure_s = std::max(entry.exposure_s, other.exposure_s);
        entry.bottom_exposure_s = std::max(entry.bottom_exposure_s, other.bottom_exposure_s);
    }
    entry.bottom_layers = most_bottom_layers(printer);
    warnings.push_back(
        fmt::format("resin \"{}\" is not in the printer file: exposures of {} s and {} s (bottom layers) are assumed",
                    resin, entry.exposure_s, entry.bottom_exposure_s));
    return entry;
}

Result<double> seconds_of(const std::string& option, const std::string& text) {
    const Result<double> seconds = parse_quantity(text, Dimension::time);
    if (!seconds) return input_error("--exposure {}: {}", option, seconds.error().message);
    if (!(*seconds >= job::shortest_exposure_s && *seconds <= job::longest_exposure_s))
        return input_error("--exposure {}: must be from a millisecond to an hour", option);
    return rounded_s(*seconds);
}

/// The printer file's exposure of these layers of a resin; where they differ, the nearest to `seconds`.
double usual_of_layers_s(const machine::Resin& resin, const job::ExposureSpan& span, double seconds) {
    job::Material material;
    material.exposure_s = resin.exposure_s;
    material.bottom_exposure_s = resin.bottom_exposure_s;
    const job::ExposureRule rule{resin.bottom_layers, resin.transition_layers};
    const auto usual_s = [&](int k) { return job::exposure_s(material, rule, k, rule.layer_um); };
    double nearest_s = usual_s(span.first);
    for (int k = span.first; k <= std::min(span.last, rule.bottom_layers + rule.transition_layers); ++k) {
        if (std::fabs(std::log(usual_s(k) / seconds)) < std::fabs(std::log(nearest_s / seconds)))
            nearest_s = usual_s(k);
    }
    return nearest_s;
}

/// An exposure far from the printer file's value for the resin is more often a mistake than intended.
void note_far_exposure(const std::string& option, double seconds, double usual_s, const machine::Printer& printer,
                       const machine::Resin& resin, double layer_um, std::vector<std::string>& warnings) {
    constexpr double far = 2;
    if (usual_s <= 0 || (seconds * far >= usual_s && seconds <= usual_s * far)) return;
    std::string text =
        fmt::format("--exposure {}: {:.4g} s is {:.3g} times the {:.4g} s that the printer file gives resin \"{}\"",
                    option, seconds, seconds / usual_s, usual_s, resin.name);
    if (resin.penetration_um > 0 || (resin.cure_depth_um > 0 && resin.critical_share > 0))
        text += fmt::format("; it cures {:.3g} um deep, layers are {:.4g} um",
                            machine::cure_depth_um(printer, resin, seconds), layer_um);
    warnings.push_back(text);
}

/// What --exposure says of a material: the time of all its layers and perhaps of its bottom layers, or of some layers.
struct ExposureChoice {
    std::string material;
    double seconds = 0;
    std::optional<double> bottom_s;
    std::optional<job::ExposureSpan> layers;
};

/// FIRST-LAST or one number, counted from 0; without its time.
std::optional<job::ExposureSpan> read_layers(const std::string& text) {
    const std::size_t dash = std::min(text.find('-'), text.size());
    job::ExposureSpan span{plain_number(text.substr(0, dash)), 0, 0};
    span.last = dash < text.size() ? plain_number(text.substr(dash + 1)) : span.first;
    if (span.first < 0 || span.last < span.first) return std::nullopt;
    return span;
}

/// MATERIAL=TIME, MATERIAL=TIME,BOTTOM or MATERIAL:FIRST-LAST=TIME.
Result<ExposureChoice> read_exposure(const std::string& text, const std::vector<job::Material>& materials) {
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0)
        return input_error("--exposure {}: write MATERIAL=TIME, MATERIAL=TIME,BOTTOM or MATERIAL:FIRST-LAST=TIME",
                           text);
    ExposureChoice choice{text.substr(0, equals), 0, {}, {}};
    const std::string times = text.substr(equals + 1);
    const std::size_t colon = choice.material.rfind(':'), comma = std::min(times.find(','), times.size());
    if (colon != std::string::npos) {
        choice.layers = read_layers(choice.material.substr(colon + 1));
        if (!choice.layers || comma < times.size())
            return input_error("--exposure {}: layers are FIRST-LAST, counted from 0, and have one time", text);
        choice.material.resize(colon);
    }
    if (std::ranges::find(materials, choice.material, &job::Material::name) == materials.end())
        return input_error("--exposure {}: there is no material \"{}\"", text, choice.material);
    const Result<double> seconds = seconds_of(text, times.substr(0, comma));
    if (!seconds) return tl::unexpected(seconds.error());
    choice.seconds = *seconds;
    if (comma == times.size()) return choice;
    const Result<double> bottom = seconds_of(text, times.substr(comma + 1));
    if (!bottom) return tl::unexpected(bottom.error());
    choice.bottom_s = *bottom;
    return choice;
}

void apply(const ExposureChoice& choice, job::Material& material, job::JobSettings& settings) {
    if (choice.layers) {
        auto [rule, added] = settings.exposures.try_emplace(material.name);
        if (added) rule->second.bottom_layers = material.bottom_layers.value_or(settings.bottom_layers);
        rule->second.spans.push_back({choice.layers->first, choice.layers->last, choice.seconds});
        return;
    }
    material.exposure_s = choice.seconds;
    material.bottom_exposure_s = choice.bottom_s.value_or(std::max(material.bottom_exposure_s, choice.seconds));
}

/// `given`: those before it.
Status set_exposure(const std::string& text, const machine::Printer& printer, job::JobSettings& settings,
                    std::vector<ExposureChoice>& given, std::vector<std::string>& warnings) {
    const Result<ExposureChoice> choice = read_exposure(text, settings.materials);
    if (!choice) return tl::unexpected(choice.error());
    const auto again = [&](const ExposureChoice& g) { return !g.layers && g.material == choice->material; };
    if (!choice->layers && std::any_of(given.begin(), given.end(), again))
        return input_error("--exposure {}: the exposure of \"{}\" is given twice", text, choice->material);
    given.push_back(*choice);
    const double most_s = std::max(choice->seconds, choice->bottom_s.value_or(0));
    if (most_s > printer.limits.exposure_s)
        return input_error("--exposure {}: {:g} s for \"{}\", the limit of {} is {:g} s", text, most_s,
                           choice->material, printer.name, printer.limits.exposure_s);
    job::Material& material = *std::ranges::find(settings.materials, choice->material, &job::Material::name);
    apply(*choice, material, settings);
    const machine::Resin* resin = printer.find_resin(material.resin);
    if (resin == nullptr) return {};
    const int layer_um = settings.slicing.layer_um;
    const double usual_s =
        choice->layers ? usual_of_layers_s(*resin, *choice->layers, choice->seconds) : resin->exposure_s;
    note_far_exposure(text, choice->seconds, usual_s, printer, *resin, layer_um, warnings);
    if (choice->bottom_s)
        note_far_exposure(text, *choice->bottom_s, resin->bottom_exposure_s, printer, *resin, layer_um, warnings);
    return {};
}

/// Materials that stand for bodies with exposures of their own keep them, which the name of the whole material hides.
void note_kept_exposures(const std::vector<ExposureChoice>& choices, const Drawing& drawing,
                         std::vector<std::string>& warnings) {
    const auto chosen = [&](const std::string& name) {
        return std::ranges::find(choices, name, &ExposureChoice::material) != choices.end();
    };
    for (const auto& [own, whole] : drawing.made_of) {
        if (!chosen(whole) || chosen(own)) continue;
        warnings.push_back(
            fmt::format("--exposure {}: \"{}\" keeps the exposure that the robot file gives its body; "
                        "--exposure \"{}=TIME\" sets it",
                        whole, own, own));
    }
}

}  // namespace

std::vector<job::Material> with_exposures(Drawing& drawing, const machine::Printer& printer) {
    std::vector<job::Material> materials;
    for (const auto& [material, resin] : drawing.resin_of_material) {
        const auto same_name = [&name = material](const job::Material& known) { return known.name == name; };
        if (std::any_of(materials.begin(), materials.end(), same_name)) continue;
        job::Material entry = with_exposure(material, resin, printer, drawing.warnings);
        if (const auto own = drawing.exposure_of_material.find(material); own != drawing.exposure_of_material.end()) {
            if (own->second.first > 0) entry.exposure_s = own->second.first;
            entry.bottom_exposure_s = std::max(entry.bottom_exposure_s, entry.exposure_s);
            if (own->second.second > 0) entry.bottom_exposure_s = own->second.second;
        }
        entry.exposure_s = rounded_s(entry.exposure_s);
        entry.bottom_exposure_s = rounded_s(entry.bottom_exposure_s);
        if (const auto own = drawing.colour_of_material.find(material); own != drawing.colour_of_material.end())
            entry.colour = own->second;
        materials.push_back(std::move(entry));
    }
    return materials;
}

std::map<std::string, job::ExposureRule> exposure_rules(const Drawing& drawing, const machine::Printer& printer,
                                                        bool many_heights) {
    std::map<std::string, job::ExposureRule> rules;
    for (const auto& [material, name] : drawing.resin_of_material) {
        job::ExposureRule rule{most_bottom_layers(printer), 0, 0, printer.layer_um, {}};
        const machine::Resin* resin = printer.find_resin(name);
        if (resin != nullptr) {
            rule.bottom_layers = resin->bottom_layers;
            rule.transition_layers = resin->transition_layers;
        }
        if (many_heights)
            rule.penetration_um = resin != nullptr ? machine::working_curve(printer, *resin).penetration_um
                                                   : machine::assumed_penetration_um(printer);
        if (rule.transition_layers > 0 || rule.penetration_um > 0) rules[material] = rule;
    }
    return rules;
}

void set_bottom_layers(job::JobSettings& settings) {
    for (const job::Material& m : settings.materials)
        settings.bottom_layers = std::max(settings.bottom_layers, m.bottom_layers.value_or(0));
    for (job::Material& m : settings.materials) {
        if (m.bottom_layers == settings.bottom_layers) m.bottom_layers.reset();
    }
}

Status set_exposures(const Order& order, const machine::Printer& printer, job::JobSettings& settings,
                     Drawing& drawing) {
    std::vector<ExposureChoice> given;
    for (const std::string& text : order.exposures) {
        if (Status status = set_exposure(text, printer, settings, given, drawing.warnings); !status) return status;
    }
    note_kept_exposures(given, drawing, drawing.warnings);
    return {};
}

Status check_limits(const Drawing& drawing, const std::vector<job::Material>& materials,
                    const machine::Printer& printer) {
    for (const job::Material& m : materials) {
        if (!drawing.exposure_of_material.contains(m.name) || !has_body_of(drawing, m.name)) continue;
        const double most_s = std::max(m.exposure_s, m.bottom_exposure_s);
        if (most_s > printer.limits.exposure_s)
            return input_error("material \"{}\": exposure of {:g} s, the limit of {} is {:g} s", m.name, most_s,
                               printer.name, printer.limits.exposure_s);
    }
    return {};
}

}  // namespace pliant::prepare
