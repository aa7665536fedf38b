#include "printing/prepare/settings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "base/core/letters.hpp"
#include "base/core/text.hpp"
#include "base/core/units.hpp"
#include "printing/job/exposure.hpp"
#include "printing/machine/image_room.hpp"
#include "printing/machine/working_curve.hpp"
#include "printing/plan/assign.hpp"
#include "printing/prepare/option_text.hpp"
#include "printing/prepare/paint_file.hpp"

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

/// For every material, the settings of its resin.
std::map<std::string, slice::Compensation> compensations(const Drawing& drawing, const machine::Printer& printer) {
    std::map<std::string, slice::Compensation> result;
    for (const auto& [material, name] : drawing.resin_of_material) {
        const machine::Resin* resin = printer.find_resin(name);
        if (resin == nullptr) continue;
        const slice::Compensation c{static_cast<double>(resin->xy_compensation_um),
                                    static_cast<double>(resin->elephant_foot_um), resin->elephant_foot_layers,
                                    static_cast<double>(resin->bleed_compensation_um)};
        if (c.grow_um != 0 || c.foot_um != 0 || c.bleed_um != 0) result[material] = c;
    }
    return result;
}

/// Exposure rules of the materials whose layers are not all exposed alike.
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

struct Pair {
    std::string first, second;
    int pixels = 0, layers = 0;
    std::string named{};  ///< the pair that was given, as in "soft and firm"
};

/// FIRST+SECOND=PIXELS or FIRST+SECOND=PIXELS,LAYERS.
Result<Pair> read_pair(const char* option, const std::string& text, int default_layers) {
    const std::size_t equals = text.rfind('='), plus = text.find('+');
    if (equals == std::string::npos || plus == std::string::npos || plus > equals)
        return input_error("{} {}: write MATERIAL+MATERIAL=PIXELS or MATERIAL+MATERIAL=PIXELS,LAYERS", option, text);
    const std::string numbers = text.substr(equals + 1);
    const std::size_t comma = std::min(numbers.find(','), numbers.size());
    Pair pair{text.substr(0, plus), text.substr(plus + 1, equals - plus - 1), 0, default_layers};
    pair.named = pair.first + " and " + pair.second;
    pair.pixels = plain_number(numbers.substr(0, comma));
    if (comma < numbers.size()) pair.layers = plain_number(numbers.substr(comma + 1));
    if (pair.pixels < 0 || pair.layers < 0)
        return input_error("{} {}: \"{}\" must be whole numbers, as in 4 or 4,2", option, text, numbers);
    return pair;
}

/// The materials of bodies that a pair means by a name: that one, and those made of it for exposures of their own.
std::vector<std::string> meant_by(const std::string& name, const Order& order, const Drawing& drawing) {
    const auto is_made_of = [&](const slice::Body& b) {
        return b.material == name || (b.blend && b.blend->second == name);
    };
    std::vector<std::string> names;
    for (const auto& [own, whole] : drawing.made_of) {
        if (whole == name) names.push_back(own);
    }
    if (names.empty() || name == order.support || std::any_of(drawing.bodies.begin(), drawing.bodies.end(), is_made_of))
        names.insert(names.begin(), name);
    return names;
}

/// The pairs of an option, in order; a pair that is named itself is left as it is named.
Result<std::vector<Pair>> pairs_of(const char* option, const std::vector<std::string>& texts, int default_layers,
                                   const Order& order, const Drawing& drawing) {
    std::vector<Pair> named, meant;
    for (const std::string& text : texts) {
        Result<Pair> pair = read_pair(option, text, default_layers);
        if (!pair) return tl::unexpected(pair.error());
        named.push_back(std::move(*pair));
    }
    const auto is_named = [&](const std::string& a, const std::string& b) {
        return std::any_of(named.begin(), named.end(), [&](const Pair& p) {
            return (p.first == a && p.second == b) || (p.first == b && p.second == a);
        });
    };
    for (const Pair& pair : named) {
        if (pair.first == pair.second) {
            meant.push_back(pair);
            continue;
        }
        for (const std::string& first : meant_by(pair.first, order, drawing)) {
            for (const std::string& second : meant_by(pair.second, order, drawing)) {
                const bool itself = first == pair.first && second == pair.second;
                if (!itself && (first == second || is_named(first, second))) continue;
                meant.push_back({first, second, pair.pixels, pair.layers, pair.named});
            }
        }
    }
    return meant;
}

Status set_pairs(const Order& order, const Drawing& drawing, slice::Settings& slicing) {
    if (!drawing.stacks.empty() && !(order.interlocks.empty() && order.overlaps.empty()))
        return input_error("--interlock, --overlap: layer images are printed as they are");
    const auto interlocks = pairs_of("--interlock", order.interlocks, 1, order, drawing);
    if (!interlocks) return tl::unexpected(interlocks.error());
    for (const Pair& p : *interlocks) slicing.teeth.push_back({p.first, p.second, p.pixels, p.layers, p.named});
    const auto overlaps = pairs_of("--overlap", order.overlaps, 0, order, drawing);
    if (!overlaps) return tl::unexpected(overlaps.error());
    for (const Pair& p : *overlaps) slicing.bonds.push_back({p.first, p.second, p.pixels, p.layers, p.named});
    return {};
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

/// Reports a misspelt resin before anything is sliced; checks only materials in use.
Status check_resins(const Drawing& drawing, const std::vector<job::Material>& materials,
                    const machine::Printer& printer) {
    std::vector<job::Material> used;
    for (const job::Material& m : materials) {
        const auto is_made_of = [&](const slice::Body& b) {
            return b.material == m.name || (b.blend && b.blend->second == m.name);
        };
        const auto shows = [&](const job::MaterialStack& s) { return s.material == m.name; };
        if (std::any_of(drawing.bodies.begin(), drawing.bodies.end(), is_made_of) ||
            std::any_of(drawing.stacks.begin(), drawing.stacks.end(), shows))
            used.push_back(m);
    }
    return plan::check_resins(used, printer);
}

/// The most bottom layers of a material are those of the job; a material with fewer keeps its own number.
void set_bottom_layers(job::JobSettings& settings) {
    for (const job::Material& m : settings.materials)
        settings.bottom_layers = std::max(settings.bottom_layers, m.bottom_layers.value_or(0));
    for (job::Material& m : settings.materials) {
        if (m.bottom_layers == settings.bottom_layers) m.bottom_layers.reset();
    }
}

/// Adds the material of supports, in the resin of its name or of --resin, unless a body has it already.
Status add_support_material(const Order& order, const machine::Printer& printer, Drawing& drawing) {
    if (order.support.empty()) return {};
    const auto known = [&](const auto& pair) { return pair.first == order.support; };
    if (std::none_of(drawing.resin_of_material.begin(), drawing.resin_of_material.end(), known))
        drawing.resin_of_material.emplace_back(order.support, order.support);
    else
        return {};
    const auto given = [&](const std::string& choice) { return choice.starts_with(order.support + "="); };
    if (printer.find_resin(order.support) != nullptr || std::any_of(order.resins.begin(), order.resins.end(), given))
        return {};
    std::vector<std::string> names;
    for (const auto& [material, resin] : drawing.resin_of_material) {
        if (material != order.support) names.push_back(material);
    }
    for (const machine::Resin& resin : printer.resins) {
        if (std::find(names.begin(), names.end(), resin.name) == names.end()) names.push_back(resin.name);
    }
    return input_error(
        "--support {0}: is neither a material of the part nor a resin of the printer ({1}); or say --resin {0}=RESIN",
        order.support, join_names(names));
}

/// Options that do not apply to layer images.
Status check_stacks(const Order& order, const Drawing& drawing) {
    if (drawing.stacks.empty()) return {};
    const std::pair<const char*, bool> given[] = {{"--copies", order.copies != 1},
                                                  {"--turn", !order.turn.empty()},
                                                  {"--scale", order.scale != 1},
                                                  {"--at", !order.at.empty()},
                                                  {"--least-layer", !order.least_layer.empty()},
                                                  {"--spacing", order.spacing != Order{}.spacing},
                                                  {"--support", !order.support.empty()},
                                                  {"--support-angle", !order.support_angle.empty()},
                                                  {"--support-spacing", !order.support_spacing.empty()},
                                                  {"--support-tip", !order.support_tip.empty()},
                                                  {"--support-pillar", !order.support_pillar.empty()},
                                                  {"--support-paint", !order.support_paint.empty()},
                                                  {"--lift", !order.lift.empty()},
                                                  {"--raft", !order.raft.empty()},
                                                  {"--hollow", !order.hollow.empty()},
                                                  {"--drain", !order.drain.empty()},
                                                  {"--no-anti-alias", order.no_anti_alias},
                                                  {"--threshold", order.threshold != Order{}.threshold}};
    for (const auto& [option, is_given] : given) {
        if (is_given) return input_error("{}: layer images are printed as they are", option);
    }
    return {};
}

std::string um_text(double um) {
    return fmt::format("{:g} um", um);
}

/// The layer height stated by the stacks, if any; all must agree.
Result<std::optional<double>> stacked_layer_um(const Drawing& drawing) {
    constexpr double same_um = 1e-3;
    const job::MaterialStack* first = nullptr;
    for (const job::MaterialStack& s : drawing.stacks) {
        if (!s.stack.layer_um()) continue;
        if (first == nullptr) first = &s;
        if (std::fabs(*s.stack.layer_um() - *first->stack.layer_um()) > same_um)
            return input_error(
                "images of \"{}\" are for layers of {}, those of \"{}\" for {}: slice them in the same layer height",
                first->material, um_text(*first->stack.layer_um()), s.material, um_text(*s.stack.layer_um()));
    }
    if (first == nullptr) return std::nullopt;
    return first->stack.layer_um();
}

/// Images made for pixels of another size would give a part that is too large or too small.
Status check_pixels(const Drawing& drawing, const machine::Projector& projector) {
    constexpr double rounding = 0.005;  // of displays stated in tenths of a millimetre
    for (const job::MaterialStack& s : drawing.stacks) {
        const std::optional<job::PixelSize> pixel = s.stack.pixel();
        if (!pixel) continue;
        for (const auto& [um, way] : {std::pair{pixel->x_um, "wide"}, {pixel->y_um, "deep"}}) {
            if (std::fabs(projector.pixel_um / um - 1) <= rounding) continue;
            return input_error(
                "images of \"{}\" are for pixels of {:.4g} x {:.4g} um, the projector has {:.4g} um: the part would "
                "come out {:.3g} times as {}; slice it for this printer",
                s.material, pixel->x_um, pixel->y_um, projector.pixel_um, projector.pixel_um / um, way);
        }
    }
    return {};
}

/// --layer, else the height that layer images were made for, else the printer's. Images printed at another layer height
/// would give a part that is too tall or too short.
Result<int> layer_of(const Order& order, const machine::Printer& printer, Drawing& drawing) {
    const Result<std::optional<double>> stacked = stacked_layer_um(drawing);
    if (!stacked) return tl::unexpected(stacked.error());
    const Result<int> asked = order.layer.empty() ? printer.layer_um : layer_height_um("--layer", order.layer);
    if (!asked) return asked;
    if (!*stacked) {
        if (!drawing.stacks.empty() && order.layer.empty())
            drawing.warnings.push_back(
                fmt::format("layer images do not say how high their layers are: {} "
                            "of the printer file are assumed; --layer gives another height",
                            um_text(*asked)));
        return asked;
    }
    const double um = std::round(**stacked);
    if (std::fabs(um - **stacked) > 1e-3 || um > 1000)
        return input_error("layer images are for layers of {}: a whole number of micrometres from 1 to 1000 is needed",
                           um_text(**stacked));
    if (!order.layer.empty() && *asked != static_cast<int>(um))
        return input_error(
            "--layer {}: the layer images are for layers of {}, the part would come out {:.3g} times as high: leave "
            "--layer out, or slice again",
            order.layer, um_text(um), *asked / um);
    return static_cast<int>(um);
}

/// The tops of the first layers of stacks whose first layer has a height of its own, as PrusaSlicer writes them; empty
/// where it is as high as the others.
Result<std::vector<int>> stacked_tops_um(const Drawing& drawing, int layer_um) {
    std::optional<int> first_um;
    for (const job::MaterialStack& s : drawing.stacks) {
        const double stated_um = s.stack.first_layer_um().value_or(layer_um), um = std::round(stated_um);
        if (std::fabs(um - stated_um) > 1e-3 || um < 1 || um > 1000)
            return input_error(
                "the first layer of \"{}\" is {} high: a whole number of micrometres from 1 to 1000 is needed",
                s.material, um_text(stated_um));
        if (first_um && *first_um != static_cast<int>(um))
            return input_error("the first layer of \"{}\" is {} high, that of another stack {}: slice them alike",
                               s.material, um_text(um), um_text(*first_um));
        first_um = static_cast<int>(um);
    }
    if (first_um.value_or(layer_um) == layer_um) return std::vector<int>{};
    return std::vector<int>{*first_um, *first_um + layer_um};
}

/// Names of materials and resins go to terminals, and into comments of programs.
Status check_names(const Drawing& drawing) {
    for (const auto& [material, resin] : drawing.resin_of_material) {
        for (const std::string& name : {material, resin}) {
            if (std::any_of(name.begin(), name.end(), is_control))
                return input_error("material \"{}\": a name must have no line breaks or other control characters",
                                   one_line(name));
        }
    }
    return {};
}

/// Exposures of a robot file; those of printer file and options are checked where they are read.
Status check_limits(const Drawing& drawing, const std::vector<job::Material>& materials,
                    const machine::Printer& printer) {
    for (const job::Material& m : materials) {
        const auto printed = [&](const slice::Body& body) {
            return body.material == m.name || (body.blend && body.blend->second == m.name);
        };
        if (!drawing.exposure_of_material.contains(m.name) || std::ranges::none_of(drawing.bodies, printed)) continue;
        const double most_s = std::max(m.exposure_s, m.bottom_exposure_s);
        if (most_s > printer.limits.exposure_s)
            return input_error("material \"{}\": exposure of {:g} s, the limit of {} is {:g} s", m.name, most_s,
                               printer.name, printer.limits.exposure_s);
    }
    return {};
}

/// Walls are found that are narrower by a pixel: with less than two pixels, none would be. 0: not asked for.
Result<double> least_feature_um(const Order& order, double pixel_um) {
    constexpr double most_um = 10000, rounding_um = 1e-6;
    const Result<double> least_um = length_um("--least-feature", order.least_feature, 0, 1e-3, most_um);
    if (least_um && !order.least_feature.empty() && *least_um < 2 * pixel_um - rounding_um)
        return input_error("--least-feature {}: must be {:.6g} to {:.6g} mm, at least two pixels of {:.6g} um",
                           order.least_feature, 2 * pixel_um / 1000, most_um / 1000, pixel_um);
    return least_um;
}

}  // namespace

Result<job::JobSettings> job_settings(const Order& order, const machine::Printer& printer,
                                      std::optional<job::Image> mask, Drawing& drawing) {
    if (Status status = check_stacks(order, drawing); !status) return tl::unexpected(status.error());
    if (Status status = add_support_material(order, printer, drawing); !status) return tl::unexpected(status.error());
    if (Status status = set_resins(order.resins, drawing); !status) return tl::unexpected(status.error());
    job::JobSettings settings;
    settings.name = one_line(drawing.name);
    if (Status status = check_names(drawing); !status) return tl::unexpected(status.error());
    settings.pliant_version = order.version;
    settings.slicing.raster = machine::raster_of(printer.projector);
    settings.edge = machine::platform_edge(printer);
    if (!printer.projector.grey.empty()) settings.light.grey = slice::grey_values(printer.projector.grey);
    settings.light.mask = std::move(mask);
    settings.copies = order.copies;
    settings.items = drawing.items;
    settings.most_exposure_s = printer.limits.exposure_s;
    settings.printer = printer.name;
    settings.build_height_um = printer.platform.build_height_um;
    settings.any_vat = order.any_vat;
    if (Status status = check_pixels(drawing, printer.projector); !status) return tl::unexpected(status.error());
    const Result<int> layer_um = layer_of(order, printer, drawing);
    if (!layer_um) return tl::unexpected(layer_um.error());
    settings.slicing.layer_um = *layer_um;
    Result<std::vector<int>> tops_um = stacked_tops_um(drawing, *layer_um);
    if (!tops_um) return tl::unexpected(tops_um.error());
    settings.slicing.tops_um = std::move(*tops_um);
    settings.materials = with_exposures(drawing, printer);
    set_bottom_layers(settings);
    if (!order.any_vat) {
        if (Status status = check_resins(drawing, settings.materials, printer); !status)
            return tl::unexpected(status.error());
    }
    settings.exposures = exposure_rules(drawing, printer, !order.least_layer.empty());
    std::vector<ExposureChoice> given;
    for (const std::string& text : order.exposures) {
        if (Status status = set_exposure(text, printer, settings, given, drawing.warnings); !status)
            return tl::unexpected(status.error());
    }
    note_kept_exposures(given, drawing, drawing.warnings);
    if (Status status = check_limits(drawing, settings.materials, printer); !status)
        return tl::unexpected(status.error());
    settings.slicing.compensation = compensations(drawing, printer);
    if (!drawing.stacks.empty() && !settings.slicing.compensation.empty()) {
        settings.slicing.compensation.clear();
        drawing.warnings.emplace_back(
            "xy_compensation, elephant_foot and bleed_compensation: layer images are printed as they are");
    }
    if (Status status = set_pairs(order, drawing, settings.slicing); !status) return tl::unexpected(status.error());
    const Result<double> least_um = least_feature_um(order, settings.slicing.raster.pixel_um);
    if (!least_um) return tl::unexpected(least_um.error());
    settings.least_feature_um = *least_um;
    if (order.threshold != Order{}.threshold && !order.no_anti_alias)
        return input_error("--threshold {:g}: is that of images without anti-aliasing; add --no-anti-alias",
                           order.threshold);
    settings.slicing.rules.anti_alias = !order.no_anti_alias;
    settings.slicing.rules.threshold = order.threshold;
    return settings;
}

job::Request request_of(const Order& order, const job::JobSettings& settings) {
    job::Request request{order.inputs, order.assignments, order.turn, order.spacing};
    request.scale = order.scale;
    request.at_mm = order.at;
    if (!order.least_layer.empty() && !settings.slicing.tops_um.empty()) {
        const Result<int> least = layer_height_um("--least-layer", order.least_layer);
        request.least_layer_um = least.value_or(0);
    }
    const std::pair<const char*, const std::string*> texts[] = {{"support", &order.support},
                                                                {"support_angle", &order.support_angle},
                                                                {"support_spacing", &order.support_spacing},
                                                                {"support_tip", &order.support_tip},
                                                                {"support_pillar", &order.support_pillar},
                                                                {"lift", &order.lift},
                                                                {"raft", &order.raft},
                                                                {"hollow", &order.hollow},
                                                                {"drain", &order.drain}};
    for (const auto& [key, text] : texts) {
        if (!text->empty()) request.supports.emplace_back(key, *text);
    }
    if (!order.support_paint.empty()) request.supports.emplace_back("support_paint", paint_entry);
    return request;
}

}  // namespace pliant::prepare
