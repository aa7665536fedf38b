// The table of all HTTP routes. The OpenAPI description is generated from it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "studio/base/http.hpp"

namespace pliant::studio {

class Studio;

struct Route {
    std::string method;
    std::string path;     ///< "/api/job/layers/{layer}"; {name} matches one path segment
    std::string summary;  ///< for the OpenAPI description
    std::string answers;  ///< media type of the response
    bool steers = false;  ///< only allowed for the page in control
    std::function<Response(Studio&, const Request&)> answer;
    std::string takes = {};  ///< media type of the body, "" for none
    bool streams = false;    ///< reads the body itself, piece by piece
};

[[nodiscard]] std::vector<Route> all_routes();
void add_project_routes(std::vector<Route>& routes);
void add_edit_routes(std::vector<Route>& routes);
void add_simulation_routes(std::vector<Route>& routes);
void add_search_routes(std::vector<Route>& routes);
void add_file_routes(std::vector<Route>& routes);
void add_make_routes(std::vector<Route>& routes);
void add_print_routes(std::vector<Route>& routes);
void add_printer_routes(std::vector<Route>& routes);

/// True if the path matches; fills request.parts.
[[nodiscard]] bool matches(const Route& route, Request& request);
/// OpenAPI 3.0, JSON.
[[nodiscard]] std::string open_api(const std::vector<Route>& routes, const std::string& version);

}  // namespace pliant::studio
