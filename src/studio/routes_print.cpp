// The print: which machine, and what the host's control may be asked for, docs/reference/host-api.md.
#include <nlohmann/json.hpp>

#include "studio/studio.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

Response done(const Status& status) {
    return status ? json_response("{}") : error_response(status.error());
}

double speed_of(const Request& request) {
    const Json json = Json::parse(request.body, nullptr, false);
    return json.is_object() && json.contains("speed") && json["speed"].is_number() ? json["speed"].get<double>() : 1;
}

Response take_twin(Studio& studio, const Request& request) {
    const auto job = studio.make().job();
    if (!job) return error_response(404, "there is no job yet: slice the robot, or open a job file");
    return done(studio.print().take_twin(job->file, speed_of(request)));
}

/// "/api/print/host/printer/axes" is the host's "/api/printer/axes".
Response forward(Studio& studio, const Request& request) {
    std::string path = "/api/" + request.parts.at("what");
    if (const auto more = request.parts.find("more"); more != request.parts.end()) path += "/" + more->second;
    host::ApiAnswer answer = studio.print().ask(request.method, path, request.body);
    return {answer.status == 204 ? 200 : answer.status, "application/json",
            answer.json.empty() ? "{}" : std::move(answer.json)};
}

}  // namespace

void add_print_routes(std::vector<Route>& routes) {
    const std::string json = "application/json";
    routes.push_back({"GET", "/api/print", "the machine, its job, where both stand", json, false,
                      [](Studio& s, const Request&) { return json_response(s.print().describe()); }});
    routes.push_back({"POST", "/api/print/twin",
                      "takes a virtual printer for the job: {\"speed\"} times as fast as the wall's clock", json, true,
                      take_twin, json});
    routes.push_back({"POST", "/api/print/speed", "another {\"speed\"} of the virtual printer", json, true,
                      [](Studio& s, const Request& r) { return done(s.print().set_speed(speed_of(r))); }, json});
    routes.push_back({"POST", "/api/print/leave", "gives the machine back", json, true,
                      [](Studio& s, const Request&) { return done(s.print().give_back()); }});
    // Whoever sees that something goes wrong may stop it.
    routes.push_back(
        {"POST", "/api/print/stop", "emergency stop, by any page", json, false, [](Studio& s, const Request&) {
             const host::ApiAnswer answer = s.print().ask("POST", "/api/printer/stop", "");
             return answer.status == 204 ? json_response("{}") : error_response(404, "no machine has been taken");
         }});
    routes.push_back({"GET", "/api/print/host/{what}", "the host's GET /api/{what}", json, false, forward});
    routes.push_back({"POST", "/api/print/host/{what}", "the host's POST /api/{what}", json, true, forward, json});
    routes.push_back(
        {"POST", "/api/print/host/{what}/{more}", "the host's POST /api/{what}/{more}", json, true, forward, json});
}

}  // namespace pliant::studio
