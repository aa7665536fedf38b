// The job: slicing, its layers, its plan.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "base/core/files.hpp"
#include "presentation/studio/examples.hpp"
#include "presentation/studio/job_part.hpp"
#include "presentation/studio/slice_order.hpp"
#include "presentation/studio/slice_robot.hpp"
#include "presentation/studio/studio.hpp"
#include "printing/job/manifest.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/timeline.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

std::string dumped(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Response no_job() {
    return error_response(404, "there is no job yet: slice the robot, or open a job file");
}

/// The number behind `words`, or -1.
int number_behind(const std::string& text, const std::string& words) {
    const std::size_t at = text.find(words);
    if (at == std::string::npos) return -1;
    int number = -1;
    std::from_chars(text.data() + at + words.size(), text.data() + text.size(), number);
    return number;
}

/// Where in the stack a remark of the slicer belongs, or -1.
int layer_of(const std::string& remark) {
    for (const char* words : {"in layer ", "is layer ", "in layers ", "from layer ", "layer "}) {
        if (const int layer = number_behind(remark, words); layer >= 0) return layer;
    }
    return -1;
}

/// The same text with layers counted from 1, as the page counts them; the slicer's own count from 0.
std::string from_one(const std::string& text) {
    static const std::regex layers(R"(\b(layers? )(\d+)( to )?(\d+)?)");
    const auto next = [](const std::string& digits) { return std::to_string(std::stol(digits) + 1); };
    std::string out;
    std::size_t at = 0;
    for (std::sregex_iterator m(text.begin(), text.end(), layers); m != std::sregex_iterator(); ++m) {
        const auto begin = static_cast<std::size_t>(m->position());
        out += text.substr(at, begin - at) + (*m)[1].str() + next((*m)[2]) + (*m)[3].str();
        if ((*m)[4].matched) out += (*m)[3].matched ? next((*m)[4]) : (*m)[4].str();
        at = begin + static_cast<std::size_t>(m->length());
    }
    return out + text.substr(at);
}

/// What the slicer has found, with a place; then its remarks.
Json issues_json(const job::Manifest& manifest) {
    static const std::map<std::string, const char*> names = {{"island", "island, begins in mid-air"},
                                                             {"trap", "trap, closed for good around resin"},
                                                             {"cup", "cup, holds on to the vat until it opens"},
                                                             {"thin", "thin, narrower than asked for"}};
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
        issues.push_back({{"text", from_one(warning)}, {"layer", layer_of(warning)}});
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

Response job(Studio& studio, const Request&) {
    const auto open = studio.make().job();
    if (!open) return no_job();
    const job::Manifest& manifest = open->archive.manifest();
    const Result<plan::Plan> plan = plan::make_plan(manifest, open->printer);
    const auto& p = open->printer;
    Json json = {{"revision", open->revision},
                 {"file", open->file.filename().string()},
                 {"saved", studio.folder().holds(open->file)},
                 {"manifest", Json::parse(job::to_json(manifest))},
                 {"colours", open->colours},
                 {"issues", issues_json(manifest)},
                 {"projector", Json::parse(projector_json(p.projector))},
                 {"platform", {{"width_mm", p.platform.width_um / 1e3}, {"depth_mm", p.platform.depth_um / 1e3}}},
                 {"printer", p.name}};
    if (plan) {
        json["plan"] = Json::parse(plan::plan_json(*plan));
        json["swap"] = swap_json(*plan, p);
    } else {
        json["plan_error"] = plan.error().message;
    }
    return json_response(dumped(json));
}

/// Every device over the whole print, in rows of begin, end, begin, end, ...; visits in rows of layer, slot, begin,
/// end.
Response timeline(Studio& studio, const Request&) {
    const auto open = studio.make().job();
    if (!open) return no_job();
    const job::Manifest& manifest = open->archive.manifest();
    const Result<plan::Plan> plan = plan::make_plan(manifest, open->printer);
    if (!plan) return error_response(plan.error());
    const plan::JobTimeline all = plan::job_timeline(*plan, manifest, open->printer);
    const auto rounded = [](double s) { return std::round(s * 1000) / 1000; };
    Json devices = Json::array(), visits = Json::array();
    for (const plan::Device device : all.devices) {
        Json times = Json::array();
        for (const plan::Stretch& s : all.stretches) {
            if (s.device != device) continue;
            times.push_back(rounded(s.begin_s));
            times.push_back(rounded(s.end_s));
        }
        devices.push_back({{"name", plan::device_name(device)}, {"times", std::move(times)}});
    }
    for (const plan::Visit& v : all.visits) visits.push_back({v.layer, v.slot, rounded(v.begin_s), rounded(v.end_s)});
    return json_response(dumped({{"seconds", all.seconds}, {"devices", devices}, {"visits", visits}}));
}

Response image(Studio& studio, const Request& request) {
    const auto open = studio.make().job();
    if (!open) return no_job();
    const int layer = number_behind(request.parts.at("layer"), ""),
              material = number_behind(request.parts.at("material"), "");
    const auto& layers = open->archive.manifest().layers;
    if (layer < 0 || layer >= static_cast<int>(layers.size())) return error_response(404, "there is no such layer");
    for (const job::LayerImage& entry : layers[static_cast<std::size_t>(layer)].images) {
        if (entry.material != material) continue;
        const std::lock_guard lock(open->mutex);
        Result<std::string> png = open->archive.file(entry.file);
        if (!png) return error_response(png.error());
        Response response{200, "image/png", std::move(*png)};
        response.keep = true;
        return response;
    }
    return error_response(404, "nothing of this material is in this layer");
}

Response part(Studio& studio, const Request&) {
    const auto open = studio.make().job();
    if (!open) return no_job();
    Result<std::string> packet = job_part(*open);
    if (!packet) return error_response(packet.error());
    Response response{200, "application/octet-stream", std::move(*packet)};
    response.keep = true;
    return response;
}

Response download(Studio& studio, const Request&) {
    const auto open = studio.make().job();
    if (!open) return no_job();
    Result<std::string> bytes = read_file(open->file);
    if (!bytes) return error_response(bytes.error());
    return {200, "application/zip", std::move(*bytes), "job.zip"};
}

Response save(Studio& studio, const Request& request) {
    const Json json = Json::parse(request.body, nullptr, false);
    const std::string name =
        json.is_object() && json.contains("name") && json["name"].is_string() ? json["name"].get<std::string>() : "";
    const Result<std::filesystem::path> path = studio.folder().resolve(name);
    if (!path) return error_response(path.error());
    if (path->extension() != ".zip") return error_response(422, "a job file ends with .zip");
    const Status saved = studio.make().save(*path);
    return saved ? json_response("{}") : error_response(saved.error());
}

/// The same job on every machine that is built in.
Response compare(Studio& studio, const Request&) {
    const auto open = studio.make().job();
    if (!open) return no_job();
    // What machines are compared by is not what happens to be in their vats.
    job::Manifest manifest = open->archive.manifest();
    manifest.any_vat = true;
    Json rows = Json::array();
    for (const BuiltInFile& file : example_printers()) {
        const Result<machine::Printer> printer = machine::parse_printer(file.text, std::string(file.name) + ".toml");
        if (!printer) continue;
        const Result<plan::Plan> plan = plan::make_plan(manifest, *printer);
        Json row = {{"file", file.name}, {"printer", printer->name}};
        if (plan)
            row.update({{"swaps", plan->swaps},
                        {"total_s", plan->seconds.total},
                        {"swap_s", plan->seconds.swap},
                        {"clean_s", plan->seconds.clean},
                        {"waste_ml", plan->waste_ml},
                        {"solvent_ml", plan->solvent_ml}});
        else
            row["error"] = plan.error().message;
        rows.push_back(row);
    }
    return json_response(dumped(rows));
}

/// Of the built-in ones or of the folder; with its mask, which must lie in the folder too.
Result<prepare::PrinterFile> read_printer(Studio& studio, const std::string& name) {
    prepare::PrinterFile file;
    std::filesystem::path path = name + ".toml";
    if (const BuiltInFile* known = find_file(example_printers(), name)) {
        file.text = known->text;
    } else {
        const Result<std::filesystem::path> found = studio.folder().resolve(name);
        if (!found) return tl::unexpected(found.error());
        path = *found;
        Result<std::string> text = read_file(path, std::uintmax_t{4} << 20);
        if (!text) return tl::unexpected(text.error());
        file.text = std::move(*text);
        if (!studio.folder().texts_leading_outside(file.text, path).empty())
            return input_error("{}: names a file outside of the project folder", name);
    }
    Result<machine::Printer> printer = machine::parse_printer(file.text, path.filename());
    if (!printer) return tl::unexpected(printer.error());
    file.printer = std::move(*printer);
    Result<std::optional<job::Image>> mask = operate::load_mask(file.printer.projector, path);
    if (!mask) return tl::unexpected(mask.error());
    file.mask = std::move(*mask);
    return file;
}

Result<SliceOrder> read_order(Studio& studio, const Request& request) {
    const Result<std::string> name = printer_name_of(request.body);
    if (!name) return tl::unexpected(name.error());
    Result<prepare::Order> order = read_slice_order(request.body);
    if (!order) return tl::unexpected(order.error());
    Result<prepare::PrinterFile> printer = read_printer(studio, *name);
    if (!printer) return tl::unexpected(printer.error());
    const Studio::Document d = studio.document();
    order->inputs = {d.file.filename().string()};
    return SliceOrder{d.text, d.file, std::move(*printer), std::move(*order)};
}

Response slice(Studio& studio, const Request& request) {
    Result<SliceOrder> order = read_order(studio, request);
    if (!order) return error_response(order.error());
    const Status status = studio.make().slice(std::move(*order));
    return status ? json_response("{}") : error_response(status.error());
}

/// What it will take, before it is sliced.
Response estimate(Studio& studio, const Request& request) {
    Result<SliceOrder> order = read_order(studio, request);
    if (!order) return error_response(order.error());
    const Result<plan::Plan> plan = estimate_robot(*order);
    if (!plan) return error_response(plan.error());
    Json resin = Json::object();
    for (const plan::VatUse& vat : plan->vats) resin[vat.resin] = resin.value(vat.resin, 0.0) + vat.resin_ml;
    return json_response(dumped(
        {{"layers", plan->layers}, {"seconds", plan->seconds.total}, {"swaps", plan->swaps}, {"resin_ml", resin}}));
}

/// What a form about slicing for it wants to know.
Response printer(Studio& studio, const Request& request) {
    const auto name = request.query.find("name");
    const Result<prepare::PrinterFile> file =
        read_printer(studio, name == request.query.end() ? "tower" : name->second);
    if (!file) return error_response(file.error());
    const machine::Printer& p = file->printer;
    Json resins = Json::array(), vats = Json::array();
    for (const machine::Resin& resin : p.resins)
        resins.push_back(
            {{"name", resin.name}, {"exposure_s", resin.exposure_s}, {"bottom_exposure_s", resin.bottom_exposure_s}});
    for (const machine::Vat& vat : p.vats) vats.push_back({{"slot", vat.slot}, {"resin", vat.resin}});
    return json_response(dumped(
        {{"name", p.name},
         {"layer_um", p.layer_um},
         {"pixel_um", p.projector.pixel_um},
         {"mask", p.projector.mask},
         {"image_mm",
          {p.projector.width_px * p.projector.pixel_um / 1e3, p.projector.height_px * p.projector.pixel_um / 1e3}},
         {"platform",
          {{"width_mm", p.platform.width_um / 1e3},
           {"depth_mm", p.platform.depth_um / 1e3},
           {"height_mm", p.platform.build_height_um / 1e3}}},
         {"resins", resins},
         {"vats", vats}}));
}

Response cancel(Studio& studio, const Request&) {
    studio.make().cancel();
    return json_response("{}");
}

}  // namespace

void add_make_routes(std::vector<Route>& routes) {
    const std::string json = "application/json";
    routes.push_back({"POST", "/api/job/slice", "slices the robot: {\"printer\"} and the options of pliant slice", json,
                      true, slice, json});
    routes.push_back({"POST", "/api/job/estimate", "what the print will take: the body of /api/job/slice", json, false,
                      estimate, json});
    routes.push_back({"GET", "/api/printer", "a built-in printer or one of the folder: ?name=", json, false, printer});
    routes.push_back({"POST", "/api/job/cancel", "cancels slicing", json, true, cancel});
    routes.push_back({"GET", "/api/job", "the job: manifest, plan, one swap, issues", json, false, job});
    routes.push_back({"GET", "/api/job/layers/{layer}/{material}", "one image", "image/png", false, image});
    routes.push_back(
        {"GET", "/api/job/part", "the job as it will stand, a packet", "application/octet-stream", false, part});
    routes.push_back({"GET", "/api/job/timeline", "every device over the whole print", json, false, timeline});
    routes.push_back({"GET", "/api/job/compare", "the job planned on every built-in printer", json, false, compare});
    routes.push_back({"GET", "/api/job/file", "the job file", "application/zip", false, download});
    routes.push_back({"POST", "/api/job/save", "writes the job into the folder: {\"name\"}", json, true, save, json});
}

}  // namespace pliant::studio
