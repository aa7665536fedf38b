#include "printing/prepare/settings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "base/core/letters.hpp"
#include "base/core/text.hpp"
#include "printing/machine/image_room.hpp"
#include "printing/plan/assign.hpp"
#include "printing/prepare/exposures.hpp"
#include "printing/prepare/option_text.hpp"
#include "printing/prepare/paint_file.hpp"
#include "printing/prepare/pairs.hpp"
#include "printing/prepare/stack_settings.hpp"

namespace pliant::prepare {
namespace {

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

/// Reports a misspelt resin before anything is sliced; checks only materials in use.
Status check_resins(const Drawing& drawing, const std::vector<job::Material>& materials,
                    const machine::Printer& printer) {
    std::vector<job::Material> used;
    for (const job::Material& m : materials) {
        const auto shows = [&](const job::MaterialStack& s) { return s.material == m.name; };
        if (has_body_of(drawing, m.name) || std::ranges::any_of(drawing.stacks, shows)) used.push_back(m);
    }
    return plan::check_resins(used, printer);
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
    if (Status status = set_exposures(order, printer, settings, drawing); !status)
        return tl::unexpected(status.error());
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
