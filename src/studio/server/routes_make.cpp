// The job: slicing, its layers, its plan.
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/files.hpp"
#include "base/core/json.hpp"
#include "printing/machine/built_in_printers.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/timeline.hpp"
#include "studio/base/dumped.hpp"
#include "studio/make/slice_robot.hpp"
#include "studio/print/job_json.hpp"
#include "studio/print/job_part.hpp"
#include "studio/print/printer_files.hpp"
#include "studio/requests/slice_order.hpp"
#include "studio/server/request_reading.hpp"
#include "studio/server/studio.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

Response no_job() {
    return error_response(404, no_job_text);
}

Response job(Studio& studio, const Request&) {
    const auto open = studio.make().job();
    if (!open) return no_job();
    return json_response(job_json(*open, studio.folder().holds(open->file)));
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
    return open ? layer_image(*open, request) : no_job();
}

/// The job to compare with: ?name= in the folder, or by default the previous one.
Result<std::shared_ptr<OpenJob>> other_job(Studio& studio, const Request& request) {
    const std::string name = asked_for(request, "name");
    if (name.empty()) return studio.make().other();
    const Result<std::filesystem::path> path = studio.folder().resolve(name);
    if (!path) return tl::unexpected(path.error());
    if (lower_extension(*path) != ".zip") return input_error("\"{}\": a job (.zip) is needed", name);
    return studio.make().other(*path);
}

Response other(Studio& studio, const Request& request) {
    const auto open = other_job(studio, request);
    if (!open) return error_response(open.error());
    if (!*open) return json_response("null");
    return json_response(job_json(**open, studio.folder().holds((*open)->file)));
}

Response other_image(Studio& studio, const Request& request) {
    const auto open = other_job(studio, request);
    if (!open) return error_response(open.error());
    return *open ? layer_image(**open, request) : Response{204, "image/png", ""};
}

Response under_way(Studio& studio, const Request&) {
    return json_response(studio.make().under_way().json());
}

Response image_under_way(Studio& studio, const Request& request) {
    Result<std::string> png = studio.make().under_way().image(whole_number(request.parts.at("layer")),
                                                              whole_number(request.parts.at("material")));
    // Slicing may have ended since the page asked: that is no mistake of the page.
    if (!png) return {204, "image/png", ""};
    return {200, "image/png", std::move(*png)};
}

Response part(Studio& studio, const Request& request) {
    const auto open = studio.make().job();
    if (!open) return no_job();
    if (is_of_another_job(*open, request)) return {204, "application/octet-stream", ""};
    Result<std::string> packet = job_part(*open);
    if (!packet) return error_response(packet.error());
    Response response{200, "application/octet-stream", std::move(*packet)};
    response.keep = names_job(request);
    return response;
}

Response download(Studio& studio, const Request&) {
    const auto open = studio.make().job();
    if (!open) return no_job();
    Result<std::string> bytes = read_file(open->file);
    if (!bytes) return error_response(bytes.error());
    if (const Status unchanged = open->unchanged(); !unchanged) return error_response(unchanged.error());
    return {200, "application/zip", std::move(*bytes), "job.zip"};
}

Response save(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"name"}}); !known) return error_response(known.error());
    const Result<std::filesystem::path> path = studio.folder().resolve(body_text(request, "name"));
    if (!path) return error_response(path.error());
    if (lower_extension(*path) != ".zip") return error_response(422, "a job file ends with .zip");
    return done(studio.make().save(*path));
}

/// Plans the same job for every built-in machine.
Response compare_printers(Studio& studio, const Request&) {
    const auto open = studio.make().job();
    if (!open) return no_job();
    // The contents of vats must not affect the comparison of machines.
    job::Manifest manifest = open->archive.manifest();
    manifest.any_vat = true;
    Json rows = Json::array();
    for (const EmbeddedFile& file : machine::built_in_printers()) {
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

Result<SliceOrder> read_order(Studio& studio, const Request& request) {
    const Result<std::string> name = printer_name_of(request.body);
    if (!name) return tl::unexpected(name.error());
    Result<prepare::Order> order = read_slice_order(request.body);
    if (!order) return tl::unexpected(order.error());
    Result<prepare::PrinterFile> printer = read_printer(studio.folder(), *name);
    if (!printer) return tl::unexpected(printer.error());
    Studio::Document d = studio.document();
    // A robot of its own, as from a wizard, is not the document and has no file: errors name the key of the body.
    const Result<std::optional<std::string>> own = robot_text_of(request.body);
    if (!own) return tl::unexpected(own.error());
    if (*own) {
        d.text = **own;
        d.file = studio.folder().path() / "robot";
        d.outside.clear();
    }
    // A file on which the robot is based may have changed since the robot was opened.
    if (Status inside = studio.folder().check_texts(d.text, d.file, d.outside); !inside)
        return input_error("robot: {}", inside.error().message);
    order->inputs = {d.file.filename().string()};
    std::string source = *own ? "" : dumped({{"robot", d.digest()}, {"order", parse_json(request.body)}});
    return SliceOrder{d.text, d.file, std::move(*printer), std::move(*order), std::move(source)};
}

Response slice(Studio& studio, const Request& request) {
    studio.look_at_files();  // what is sliced is also what is shown
    Result<SliceOrder> order = read_order(studio, request);
    if (!order) return error_response(order.error());
    return done(studio.make().slice(std::move(*order)));
}

/// Estimate of time and resin before slicing, or why the order cannot be sliced: an answer, not a failed request.
Response estimate(Studio& studio, const Request& request) {
    const Result<SliceOrder> order = read_order(studio, request);
    const Result<plan::Plan> plan = order ? estimate_robot(*order) : tl::unexpected(order.error());
    if (!plan) return json_response(dumped({{"problem", plan.error().message}}));
    Json resin = Json::object();
    for (const plan::VatUse& vat : plan->vats) resin[vat.resin] = resin.value(vat.resin, 0.0) + vat.resin_ml;
    return json_response(dumped(
        {{"layers", plan->layers}, {"seconds", plan->seconds.total}, {"swaps", plan->swaps}, {"resin_ml", resin}}));
}

/// Data of a printer for the slicing form.
Response printer(Studio& studio, const Request& request) {
    const Result<prepare::PrinterFile> file = read_printer(studio.folder(), asked_for(request, "name", "tower"));
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
         {"image_offset_mm", {p.projector.offset_x_um / 1e3, p.projector.offset_y_um / 1e3}},
         {"image_turn_deg", p.projector.rotation_deg},
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
    routes.push_back({"POST", "/api/job/estimate",
                      "what the print will take, or its problem: the body of /api/job/slice", json, false, estimate,
                      json});
    routes.push_back({"GET", "/api/printer", "a built-in printer or one of the folder: ?name=", json, false, printer});
    routes.push_back({"POST", "/api/job/cancel", "cancels slicing", json, true, cancel});
    routes.push_back({"GET", "/api/job", "the job: manifest, plan, one swap, issues", json, false, job});
    routes.push_back({"GET", "/api/job/layers/{layer}/{material}",
                      "one image; 204 without content if it is not of job ?job=, its key", "image/png", false, image});
    routes.push_back({"GET", "/api/job/other",
                      "a job to compare with: ?name= of the folder; without it the one before, or null", json, false,
                      other});
    routes.push_back({"GET", "/api/job/other/{layer}/{material}", "one image of it", "image/png", false, other_image});
    routes.push_back(
        {"GET", "/api/job/under-way", "the layers of the job that is being sliced, so far", json, false, under_way});
    routes.push_back({"GET", "/api/job/under-way/{layer}/{material}",
                      "one image of them; 204 without content if it is no longer there", "image/png", false,
                      image_under_way});
    routes.push_back(
        {"GET", "/api/job/part", "the job as it will stand, a packet", "application/octet-stream", false, part});
    routes.push_back({"GET", "/api/job/timeline", "every device over the whole print", json, false, timeline});
    routes.push_back(
        {"GET", "/api/job/compare", "the job planned on every built-in printer", json, false, compare_printers});
    routes.push_back({"GET", "/api/job/file", "the job file", "application/zip", false, download});
    routes.push_back({"POST", "/api/job/save", "writes the job into the folder: {\"name\"}", json, true, save, json});
}

}  // namespace pliant::studio
