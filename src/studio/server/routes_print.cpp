// The print: the choice of machine, and requests to the host's control, docs/reference/host-api.md.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"
#include "base/core/parse_all.hpp"
#include "presentation/print_report/print_report.hpp"
#include "studio/print/job_json.hpp"
#include "studio/print/journal_names.hpp"
#include "studio/print/journal_view.hpp"
#include "studio/server/request_reading.hpp"
#include "studio/server/studio.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

double speed_of(const Request& request) {
    return number_at(parse_json(request.body), "speed", 1);
}

Response take_twin(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"speed", BodyKey::Kind::number}}); !known)
        return error_response(known.error());
    const auto job = studio.make().job();
    if (!job) return error_response(404, no_job_text);
    // A job that was never saved has no place for a journal either.
    const bool lies = studio.folder().holds(job->file);
    return done(studio.print().take_twin(
        {job->file, job->origin.colours, lies ? virtual_journal(job->file) : std::filesystem::path(), job->key,
         job->origin.scratch, job->stamp},
        speed_of(request)));
}

/// Device and projector as for `pliant print`; a projector folder is created in the project.
Response take_port(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"device"}, {"projector"}, {"speed", BodyKey::Kind::number}, {"clock"}});
        !known)
        return error_response(known.error());
    const auto job = studio.make().job();
    if (!job) return error_response(404, no_job_text);
    if (!studio.folder().holds(job->file))
        return error_response(409, "save the job into the folder first: the print journal is stored next to it");
    const Json json = parse_json(request.body);
    const Result<std::string> projector = projector_place(studio.folder(), text_at(json, "projector"));
    if (!projector) return error_response(projector.error());
    operate::PortOptions port{text_at(json, "device"), *projector, speed_of(request), {}, {}};
    if (const std::string clock = text_at(json, "clock"); !clock.empty()) {
        const Result<std::filesystem::path> file = studio.folder().resolve(clock);
        if (!file) return error_response(422, "clock: " + file.error().message);
        port.clock_file = *file;
    }
    return done(studio.print().take_port({job->file, job->origin.colours, {}, job->key, {}, job->stamp}, port));
}

Response journals(Studio& studio, const Request&) {
    std::string list;
    for (const std::string& name : studio.folder().journals()) {
        const Result<std::filesystem::path> path = studio.folder().resolve(name);
        if (path) list += (list.empty() ? "" : ",") + journal_line_json(*path, name);
    }
    return json_response("[" + list + "]");
}

Response journal(Studio& studio, const Request& request) {
    const auto name = request.query.find("name");
    if (name == request.query.end()) return error_response(422, "?name= is needed");
    const Result<std::filesystem::path> path = studio.folder().resolve(name->second);
    if (!path) return error_response(path.error());
    if (path->extension() != ".journal") return error_response(422, "a journal ends with .journal");
    Result<std::string> json = journal_json(*path, name->second);
    return json ? json_response(std::move(*json)) : error_response(json.error());
}

/// For the connected machine, or for a journal in the folder and the job beside it.
Response report_page(Studio& studio, const Request& request) {
    const auto name = request.query.find("name");
    PrintSession::Files files = studio.print().files();
    report::PrintExtras extras = studio.print().extras();
    if (name != request.query.end()) {
        const Result<std::filesystem::path> journal = studio.folder().resolve(name->second);
        if (!journal) return error_response(journal.error());
        if (journal->extension() != ".journal") return error_response(422, "a journal ends with .journal");
        files = {job_of_journal(journal->string()), *journal};
        extras = {};
    } else if (files.job.empty()) {
        return error_response(404, "no machine is connected");
    }
    std::error_code error;
    if (!std::filesystem::exists(files.journal, error)) return error_response(409, "nothing has been printed yet");
    Result<std::string> page = report::print_report(files.job, files.journal, extras);
    if (!page) return error_response(page.error());
    return {200, "text/html; charset=utf-8", std::move(*page), "print_report.html"};
}

Response set_speed(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"speed", BodyKey::Kind::number, true}}); !known)
        return error_response(known.error());
    return done(studio.print().set_speed(speed_of(request)));
}

Response set_door(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"open", BodyKey::Kind::flag}}); !known)
        return error_response(known.error());
    const Json json = parse_json(request.body);
    if (!json.is_object() || !json.contains("open") || !json["open"].is_boolean())
        return error_response(422, "{\"open\": true or false} is needed");
    return done(studio.print().set_door(json["open"].get<bool>()));
}

/// A number in the query, 0 if invalid.
template <class Number>
Number number_of(const Request& request, const char* key) {
    Number number = 0;
    return parse_all(asked_for(request, key), number) ? number : 0;
}

Response printed_part(Studio& studio, const Request& request) {
    std::string packet =
        studio.print().part(number_of<int>(request, "revision"), number_of<std::size_t>(request, "from"));
    if (packet.empty()) return {204, "application/octet-stream", ""};  // a page may ask while its machine is left
    return {200, "application/octet-stream", std::move(packet)};
}

Response printed_image(Studio& studio, const Request& request) {
    Result<std::string> png =
        studio.print().image(whole_number(request.parts.at("layer")), whole_number(request.parts.at("material")));
    if (!png) return error_response(404, png.error().message);
    return {200, "image/png", std::move(*png)};
}

/// Removes a started print from the queue.
void leave_queue(Studio& studio, const std::string& body) {
    const Json json = parse_json(body);
    if (!json.is_object() || json.value("command", Json()) != "start") return;
    const std::filesystem::path job = studio.print().files().job;
    if (studio.folder().holds(job))
        studio.queue().begun(job.lexically_relative(studio.folder().path()).generic_string());
}

Response set_queue(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"jobs", BodyKey::Kind::any}}); !known)
        return error_response(known.error());
    const Json json = parse_json(request.body);
    const auto is_text = [](const Json& name) { return name.is_string(); };
    if (!json.is_object() || !json.contains("jobs") || !json["jobs"].is_array() ||
        !std::all_of(json["jobs"].begin(), json["jobs"].end(), is_text))
        return error_response(422, "jobs: a list of names is needed");
    return done(studio.queue().set(json["jobs"].get<std::vector<std::string>>()));
}

/// "/api/print/host/printer/axes" is the host's "/api/printer/axes".
Response forward(Studio& studio, const Request& request) {
    std::string path = "/api/" + request.parts.at("what");
    if (const auto more = request.parts.find("more"); more != request.parts.end()) path += "/" + more->second;
    host::ApiAnswer answer = studio.print().ask(request.method, path, request.body);
    if (path == "/api/job" && answer.status < 300 && request.method == "POST") leave_queue(studio, request.body);
    return {answer.status, "application/json", std::move(answer.json)};
}

}  // namespace

void add_print_routes(std::vector<Route>& routes) {
    const std::string json = "application/json";
    routes.push_back({"GET", "/api/print", "the machine, its job, where both stand", json, false,
                      [](Studio& s, const Request&) { return json_response(s.print().describe()); }});
    routes.push_back({"POST", "/api/print/twin",
                      "connects a virtual printer to the job: {\"speed\"} is its speed-up factor", json, true,
                      take_twin, json});
    routes.push_back({"GET", "/api/print/ports", "serial ports and displays of this computer", json, false,
                      [](Studio&, const Request&) { return json_response(ports_json()); }});
    routes.push_back(
        {"POST", "/api/print/port",
         "connects the printer at a serial port to the job: {\"device\", \"projector\", \"speed\", \"clock\"}", json,
         true, take_port, json});
    routes.push_back({"GET", "/api/print/queue", "the jobs that wait to be printed", json, false,
                      [](Studio& s, const Request&) { return json_response(s.queue().json()); }});
    routes.push_back({"POST", "/api/print/queue", "another list in their place: {\"jobs\": [name, ...]}", json, true,
                      set_queue, json});
    routes.push_back({"GET", "/api/print/journals", "the journals of the folder", json, false, journals});
    routes.push_back({"GET", "/api/print/journal", "one of them: ?name=", json, false, journal});
    routes.push_back({"GET", "/api/print/report",
                      "HTML report of the current print, or of a journal of the folder: ?name=", "text/html", false,
                      report_page});
    routes.push_back(
        {"POST", "/api/print/speed", "sets the {\"speed\"} of the virtual printer", json, true, set_speed, json});
    routes.push_back({"POST", "/api/print/leave", "disconnects the machine", json, true,
                      [](Studio& s, const Request&) { return done(s.print().give_back()); }});
    routes.push_back({"POST", "/api/print/discard", "ends an interrupted print on the virtual printer for good", json,
                      true, [](Studio& s, const Request&) { return done(s.print().discard()); }});
    routes.push_back({"POST", "/api/print/door", "{\"open\"}: opens or closes the door of the virtual printer", json,
                      true, set_door, json});
    routes.push_back({"GET", "/api/print/verdict",
                      "of a complete print on the virtual printer: {\"passed\", \"reasons\"}; else null", json, false,
                      [](Studio& s, const Request&) { return json_response(s.print().verdict()); }});
    routes.push_back({"GET", "/api/print/verdict/picture",
                      "the cured block beside the drawing; 204 without content if there is none", "image/png", false,
                      [](Studio& s, const Request&) {
                          Result<std::string> png = s.print().verdict_picture();
                          // The machine may have been left since the page asked: that is no mistake of the page.
                          return png ? Response{200, "image/png", std::move(*png)} : Response{204, "image/png", ""};
                      }});
    routes.push_back({"GET", "/api/print/part", "the part as far as it is printed, a packet: ?revision= and ?from=",
                      "application/octet-stream", false, printed_part});
    routes.push_back({"GET", "/api/print/image/{layer}/{material}", "an image of the job that is printed", "image/png",
                      false, printed_image});
    // Every page may stop the print, not only the one in control.
    routes.push_back(
        {"POST", "/api/print/stop", "emergency stop, by any page", json, false, [](Studio& s, const Request&) {
             const host::ApiAnswer answer = s.print().ask("POST", "/api/printer/stop", "");
             return answer.status == 204 ? json_response("{}") : error_response(404, "no machine is connected");
         }});
    routes.push_back({"GET", "/api/print/host/{what}", "the host's GET /api/{what}", json, false, forward});
    routes.push_back({"POST", "/api/print/host/{what}", "the host's POST /api/{what}", json, true, forward, json});
    routes.push_back(
        {"POST", "/api/print/host/{what}/{more}", "the host's POST /api/{what}/{more}", json, true, forward, json});
}

}  // namespace pliant::studio
