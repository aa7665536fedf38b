#include "printing/prepare/settings_record.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"

namespace pliant::job {
namespace {

using Json = nlohmann::ordered_json;

/// "soft=parts/finger.stl" to "soft=finger.stl".
std::string without_folder(const std::string& input) {
    const std::size_t equals = input.find('=');
    const std::size_t slash = input.find('/');
    const bool named = equals != std::string::npos && (slash == std::string::npos || equals < slash);
    const std::size_t begin = named ? equals + 1 : 0;
    std::filesystem::path path = input.substr(begin);
    if (!path.has_filename()) path = path.parent_path();
    return input.substr(0, begin) + path.filename().string();
}

void add_exposures(const ExposureRule& rule, Json& json) {
    json["transition_layers"] = rule.transition_layers;
    json["penetration_um"] = rule.penetration_um;
    Json& spans = json["layer_exposures"] = Json::array();
    for (const ExposureSpan& span : rule.spans)
        spans.push_back({{"first_layer", span.first}, {"last_layer", span.last}, {"exposure_s", span.seconds}});
}

Json material_json(const Material& material, const JobSettings& settings) {
    const slice::Settings& slicing = settings.slicing;
    Json json{{"name", material.name},
              {"resin", material.resin},
              {"exposure_s", material.exposure_s},
              {"bottom_exposure_s", material.bottom_exposure_s},
              {"bottom_layers", material.bottom_layers.value_or(settings.bottom_layers)}};
    const auto known = slicing.compensation.find(material.name);
    const slice::Compensation c = known == slicing.compensation.end() ? slice::Compensation{} : known->second;
    json["xy_compensation_um"] = c.grow_um;
    json["elephant_foot_um"] = c.foot_um;
    json["elephant_foot_layers"] = c.foot_layers;
    json["bleed_compensation_um"] = c.bleed_um;
    if (const auto rule = settings.exposures.find(material.name); rule != settings.exposures.end())
        add_exposures(rule->second, json);
    return json;
}

Json raster_json(const slice::Raster& r) {
    return {{"width_px", r.width_px},
            {"height_px", r.height_px},
            {"pixel_um", r.pixel_um},
            {"mirror_x", r.mirror_x},
            {"mirror_y", r.mirror_y},
            {"rotation_deg", r.rotation_deg},
            {"offset_um", {r.offset_x_um, r.offset_y_um}}};
}

}  // namespace

std::string settings_json(const JobSettings& settings, const Request& request) {
    const slice::Settings& slicing = settings.slicing;
    Json root{{"pliant_version", settings.pliant_version},
              {"name", settings.name},
              {"inputs", Json::array()},
              {"assignments", request.assignments}};
    for (const std::string& input : request.inputs) root["inputs"].push_back(without_folder(input));
    root["layer_um"] = slicing.layer_um;
    if (!slicing.tops_um.empty() && request.least_layer_um > 0) root["least_layer_um"] = request.least_layer_um;
    root["raster"] = raster_json(slicing.raster);
    root["anti_alias"] = slicing.rules.anti_alias;
    root["threshold"] = slicing.rules.threshold;
    root["close_gap_um"] = slicing.rules.close_gap_um;
    root["copies"] = settings.copies;
    root["spacing"] = request.spacing;
    root["turn_deg"] = request.turn_deg.empty() ? std::vector<double>(3, 0.0) : request.turn_deg;
    root["scale"] = request.scale;
    root["at_mm"] = request.at_mm.empty() ? std::vector<double>(2, 0.0) : request.at_mm;
    root["least_feature_um"] = settings.least_feature_um;
    root["materials"] = Json::array();
    for (const Material& m : settings.materials) root["materials"].push_back(material_json(m, settings));
    root["interlock"] = Json::array();
    for (const slice::Teeth& t : slicing.teeth)
        root["interlock"].push_back(
            {{"materials", {t.first, t.second}}, {"depth_px", t.depth_px}, {"layers", t.layers}});
    root["overlap"] = Json::array();
    for (const slice::Bond& b : slicing.bonds)
        root["overlap"].push_back({{"materials", {b.first, b.second}}, {"depth_px", b.depth_px}, {"layers", b.layers}});
    for (const auto& [key, value] : request.supports) root["supports"][key] = value;
    return json_text(root, 1) + "\n";
}

}  // namespace pliant::job
