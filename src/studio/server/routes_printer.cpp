// Machine setup: printer files of the folder, the board at a port, test patterns on the projector.
#include <nlohmann/json.hpp>

#include "base/core/files.hpp"
#include "base/core/json.hpp"
#include "printing/host/projector_patterns.hpp"
#include "printing/machine/built_in_printers.hpp"
#include "printing/operate/board.hpp"
#include "studio/base/dumped.hpp"
#include "studio/print/job_json.hpp"
#include "studio/print/printer_files.hpp"
#include "studio/server/json_toml.hpp"
#include "studio/server/request_reading.hpp"
#include "studio/server/studio.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

constexpr int fastest_baud_rate = 10'000'000, largest_square_px = 1'000'000;

std::string asked_name(const Request& request) {
    return asked_for(request, "name", "tower");
}

Response setup(Studio& studio, const Request& request) {
    const std::string name = asked_name(request);
    const auto file = read_printer(studio.folder(), name);
    if (!file) return error_response(file.error());
    return json_response(
        printer_setup_json(name, file->printer, find_file(machine::built_in_printers(), name) != nullptr));
}

Response text(Studio& studio, const Request& request) {
    auto file = read_printer(studio.folder(), asked_name(request));
    if (!file) return error_response(file.error());
    return {200, "text/plain; charset=utf-8", std::move(file->text)};
}

Response make(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"from"}, {"name"}}); !known) return error_response(known.error());
    const Json json = parse_json(request.body);
    return done(new_printer(studio.folder(), text_at(json, "from"), text_at(json, "name")));
}

Response change(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"name"}, {"changes", BodyKey::Kind::any}}); !known)
        return error_response(known.error());
    const Json json = parse_json(request.body);
    if (Status list = check_changes(json); !list) return error_response(list.error());
    PrinterChanges changes;
    for (const Json& one : json["changes"]) {
        if (text_at(one, "key").empty() || !one.contains("value"))
            return error_response(422, "changes: key and value of each are needed");
        changes.emplace_back(text_at(one, "key"), toml_text(one["value"]));
    }
    return done(change_printer(studio.folder(), text_at(json, "name"), changes));
}

/// Queries the board at a port. Nothing moves: only questions are asked. Refused while a machine is connected.
Response probe(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"name"}, {"device"}, {"baud_rate", BodyKey::Kind::number}}); !known)
        return error_response(known.error());
    const Json json = parse_json(request.body);
    const auto file = read_printer(studio.folder(), text_at(json, "name"));
    if (!file) return error_response(file.error());
    if (!studio.print().files().job.empty()) return error_response(409, "a machine is connected: disconnect it first");
    const std::string device = text_at(json, "device");
    if (Status known = check_device(device); !known) return error_response(known.error());
    const Result<int> baud_rate = whole_at(json, "baud_rate", file->printer.controller.baud_rate, fastest_baud_rate);
    if (!baud_rate) return error_response(baud_rate.error());
    const Result<std::string> answers = operate::ask_board(device, *baud_rate);
    if (!answers) return error_response(answers.error());
    return json_response(board_json(*answers, file->printer));
}

Response show_pattern(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"name"},
                                            {"projector"},
                                            {"pattern"},
                                            {"square", BodyKey::Kind::number},
                                            {"seconds", BodyKey::Kind::number}});
        !known)
        return error_response(known.error());
    const Json json = parse_json(request.body);
    const auto file = read_printer(studio.folder(), text_at(json, "name"));
    if (!file) return error_response(file.error());
    const Result<int> square_px = whole_at(json, "square", 1, largest_square_px);
    if (!square_px) return error_response(square_px.error());
    const Result<std::string> where = projector_place(studio.folder(), text_at(json, "projector"));
    if (!where) return error_response(where.error());
    const ProjectorSession::Order order{*where, text_at(json, "pattern"), *square_px, number_at(json, "seconds", 0)};
    return done(studio.projector().show(order, file->printer.projector));
}

Response test_pattern(Studio& studio, const Request& request) {
    const auto file = read_printer(studio.folder(), asked_name(request));
    if (!file) return error_response(file.error());
    const int square_px = whole_number(asked_for(request, "square", "1"));
    Result<std::string> png = pattern_picture(request.parts.at("pattern"), square_px, file->printer.projector);
    if (!png) return error_response(404, png.error().message);
    return {200, "image/png", std::move(*png)};
}

/// Converts distances measured on the pattern "border" to the pixel size.
Response measured(Studio& studio, const Request& request) {
    if (Status known =
            check_body(request, {{"name"}, {"x_mm", BodyKey::Kind::number}, {"y_mm", BodyKey::Kind::number}});
        !known)
        return error_response(known.error());
    const Json json = parse_json(request.body);
    const auto file = read_printer(studio.folder(), text_at(json, "name"));
    if (!file) return error_response(file.error());
    const machine::Projector& p = file->printer.projector;
    const host::MeasuredSpan span = host::measured_span(p.width_px, p.height_px);
    Json answer = {{"x_px", span.x_px},
                   {"y_px", span.y_px},
                   {"x_mm", span.x_px * p.pixel_um / 1e3},
                   {"y_mm", span.y_px * p.pixel_um / 1e3},
                   {"pixel_um_now", p.pixel_um}};
    if (json.is_object() && json.contains("x_mm")) {
        const auto size =
            host::pixel_size(p.width_px, p.height_px, number_at(json, "x_mm", 0), number_at(json, "y_mm", 0));
        if (!size) return error_response(size.error());
        answer.update({{"pixel_um", size->pixel_um},
                       {"x_um", size->x_um},
                       {"y_um", size->y_um},
                       {"off_percent", size->off_percent}});
    }
    return json_response(dumped(answer));
}

}  // namespace

void add_printer_routes(std::vector<Route>& routes) {
    const std::string json = "application/json";
    routes.push_back({"GET", "/api/printers", "the built-in printers, to begin with", json, false,
                      [](Studio&, const Request&) { return json_response(built_in_printers_json()); }});
    routes.push_back({"GET", "/api/printer/setup", "what a machine's file says: ?name=", json, false, setup});
    routes.push_back({"GET", "/api/printer/text", "the printer file itself: ?name=", "text/plain", false, text});
    routes.push_back({"POST", "/api/printer/new", "a printer file of the folder from another: {\"from\", \"name\"}",
                      json, true, make, json});
    routes.push_back({"POST", "/api/printer/set",
                      "values of a printer file by their keys: {\"name\", \"changes\": [{\"key\", \"value\"}]}", json,
                      true, change, json});
    routes.push_back({"POST", "/api/printer/probe",
                      "what the board at a port says of itself: {\"name\", \"device\", \"baud_rate\"}", json, true,
                      probe, json});
    routes.push_back({"GET", "/api/printer/pattern/{pattern}",
                      "a test pattern as a picture: ?name=&square=", "image/png", false, test_pattern});
    routes.push_back({"POST", "/api/printer/pattern",
                      "shows a test pattern: {\"name\", \"projector\", \"pattern\", \"square\", \"seconds\"}", json,
                      true, show_pattern, json});
    routes.push_back({"POST", "/api/printer/dark", "ends the test pattern", json, false, [](Studio& s, const Request&) {
                          s.projector().dark();
                          return json_response("{}");
                      }});
    routes.push_back({"POST", "/api/printer/measured",
                      "the size of a pixel from distances on the pattern border: {\"name\", \"x_mm\", \"y_mm\"}", json,
                      false, measured, json});
}

}  // namespace pliant::studio
