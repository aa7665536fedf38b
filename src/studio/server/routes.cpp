#include "studio/server/routes.hpp"

#include <nlohmann/json.hpp>
#include <string_view>

#include "base/core/json.hpp"
#include "studio/server/studio.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

/// The next segment of a path; leaves the rest after its '/'.
std::string_view next_segment(std::string_view& path) {
    const std::size_t end = std::min(path.find('/'), path.size());
    const std::string_view segment = path.substr(0, end);
    path.remove_prefix(std::min(end + 1, path.size()));
    return segment;
}

}  // namespace

std::vector<Route> all_routes() {
    std::vector<Route> routes;
    add_project_routes(routes);
    add_edit_routes(routes);
    add_file_routes(routes);
    add_simulation_routes(routes);
    add_search_routes(routes);
    add_make_routes(routes);
    add_print_routes(routes);
    add_printer_routes(routes);
    routes.push_back(
        {"GET", "/api/openapi.json", "this description", "application/json", false,
         [](Studio& studio, const Request&) { return json_response(open_api(studio.routes(), studio.version())); }});
    return routes;
}

bool matches(const Route& route, Request& request) {
    std::string_view wanted = route.path, path = request.path;
    std::map<std::string, std::string> parts;
    while (!wanted.empty() && !path.empty()) {
        const std::string_view name = next_segment(wanted), segment = next_segment(path);
        if (name.starts_with('{') && !segment.empty())
            parts.emplace(name.substr(1, name.size() - 2), segment);
        else if (name != segment)
            return false;
    }
    if (!wanted.empty() || !path.empty() || request.path.ends_with('/')) return false;
    request.parts = std::move(parts);
    return true;
}

std::string open_api(const std::vector<Route>& routes, const std::string& version) {
    Json paths = Json::object();
    for (const Route& route : routes) {
        Json operation = {{"summary", route.summary},
                          {"responses",
                           {{"200", {{"description", "done"}, {"content", {{route.answers, Json::object()}}}}},
                            {"default", {{"description", "an object with the key error"}}}}}};
        if (route.steers) operation["description"] = "Only for the page that steers (header X-Pliant-Page).";
        if (!route.takes.empty())
            operation["requestBody"] = {{"required", true}, {"content", {{route.takes, Json::object()}}}};
        Json parameters = Json::array();
        for (std::size_t open = route.path.find('{'); open != std::string::npos;
             open = route.path.find('{', open + 1)) {
            const std::size_t close = route.path.find('}', open);
            parameters.push_back({{"name", route.path.substr(open + 1, close - open - 1)},
                                  {"in", "path"},
                                  {"required", true},
                                  {"schema", {{"type", "string"}}}});
        }
        if (!parameters.empty()) operation["parameters"] = parameters;
        std::string method = route.method;
        for (char& c : method) c = static_cast<char>(c - 'A' + 'a');
        paths[route.path][method] = operation;
    }
    const Json json = {
        {"openapi", "3.0.3"},
        {"info",
         {{"title", "Pliant studio"},
          {"version", version},
          {"description", "Frames and live input go over the WebSocket at /live: docs/reference/studio.md"}}},
        {"paths", paths}};
    return json_text(json, 1);
}

}  // namespace pliant::studio
