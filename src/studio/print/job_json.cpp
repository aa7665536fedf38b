#include "studio/print/job_json.hpp"

#include <charconv>
#include <map>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"
#include "base/core/parse_all.hpp"
#include "printing/job/manifest.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/timeline.hpp"
#include "studio/base/dumped.hpp"
#include "studio/print/printer_json.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

/// The number after `words`, or -1.
int number_behind(const std::string& text, const std::string& words) {
    const std::size_t at = text.find(words);
    if (at == std::string::npos) return -1;
    int number = -1;
    std::from_chars(text.data() + at + words.size(), text.data() + text.size(), number);
    return number;
}

/// The layer that a remark of the slicer refers to, from 0; or -1. Texts count from 1.
int layer_of(const std::string& remark) {
    for (const char* words : {"in layer ", "is layer ", "in layers ", "from layer ", "layer "}) {
        if (const int layer = number_behind(remark, words); layer > 0) return layer - 1;
    }
    return -1;
}

/// Findings of the slicer with a position; then its other remarks.
Json issues_json(const job::Manifest& manifest) {
    static const std::map<std::string, const char*> names = {{"island", "island in mid-air"},
                                                             {"trap", "resin trap, closed for good"},
                                                             {"cup", "suction cup until it opens"},
                                                             {"thin", "feature narrower than the limit"}};
    Json issues = Json::array();
    for (const job::Finding& f : manifest.findings) {
        const auto name = names.find(f.kind);
        const std::string size =
            f.volume_mm3 > 0 ? fmt::format("{:.3g} mm³", f.volume_mm3) : fmt::format("{:.3g} mm²", f.area_mm2);
        const std::string many = f.count > 1 ? fmt::format("{} times ", f.count) : "";
        issues.push_back({{"text", fmt::format("{}{}: {}", many, name == names.end() ? f.kind : name->second, size)},
                          {"severity", f.severity},
                          {"layer", f.first_layer},
                          {"row", f.row},
                          {"column", f.column}});
    }
    for (const std::string& warning : manifest.warnings)
        issues.push_back({{"text", warning}, {"layer", layer_of(warning)}});
    return issues;
}

Json swap_json(const plan::Plan& plan, const machine::Printer& printer) {
    const plan::SwapTimeline swap = plan::longest_swap(plan, printer);
    Json devices = Json::array(), stretches = Json::array();
    for (const plan::Device device : swap.devices) devices.push_back(plan::device_name(device));
    for (const plan::Stretch& s : swap.stretches)
        stretches.push_back({{"device", plan::device_name(s.device)}, {"begin", s.begin_s}, {"end", s.end_s}});
    return {{"from", swap.from_slot},
            {"to", swap.to_slot},
            {"seconds", swap.seconds},
            {"devices", devices},
            {"stretches", stretches}};
}

}  // namespace

std::string job_json(const OpenJob& open, bool saved) {
    const job::Manifest& manifest = open.archive.manifest();
    const Result<plan::Plan> plan = plan::make_plan(manifest, open.printer);
    const auto& p = open.printer;
    Json json = {{"revision", open.revision},
                 {"key", open.key},
                 {"file", open.file.filename().string()},
                 {"saved", saved},
                 {"manifest", parse_json(job::to_json(manifest))},
                 {"colours", open.origin.colours},
                 {"issues", issues_json(manifest)},
                 {"projector", projector_json(p.projector)},
                 {"platform", {{"width_mm", p.platform.width_um / 1e3}, {"depth_mm", p.platform.depth_um / 1e3}}},
                 {"source", open.origin.source.empty() ? Json(nullptr) : parse_json(open.origin.source)},
                 {"printer", p.name}};
    if (plan) {
        json["plan"] = parse_json(plan::plan_json(*plan));
        json["swap"] = swap_json(*plan, p);
    } else {
        json["plan_error"] = plan.error().message;
    }
    return dumped(json);
}

bool names_job(const Request& request) {
    return request.query.count("job") != 0;
}

bool is_of_another_job(const OpenJob& open, const Request& request) {
    return names_job(request) && request.query.find("job")->second != open.key;
}

Response layer_image(OpenJob& open, const Request& request) {
    if (is_of_another_job(open, request)) return {204, "image/png", ""};
    const int layer = whole_number(request.parts.at("layer")), material = whole_number(request.parts.at("material"));
    const auto& layers = open.archive.manifest().layers;
    if (layer < 0 || layer >= static_cast<int>(layers.size())) return error_response(404, "there is no such layer");
    for (const job::LayerImage& entry : layers[static_cast<std::size_t>(layer)].images) {
        if (entry.material != material) continue;
        if (const Status unchanged = open.unchanged(); !unchanged) return error_response(unchanged.error());
        const std::lock_guard lock(open.mutex);
        Result<std::string> png = open.archive.file(entry.file);
        if (!png) return error_response(png.error());
        Response response{200, "image/png", std::move(*png)};
        response.keep = names_job(request);
        return response;
    }
    return error_response(404, "nothing of this material is in this layer");
}

int whole_number(std::string_view text) {
    int value = -1;
    return parse_all(text, value) ? value : -1;
}

}  // namespace pliant::studio
