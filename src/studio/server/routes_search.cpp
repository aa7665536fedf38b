// Goals and identification: options, the search, its result.
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "base/core/parse_all.hpp"
#include "simulation/identify/unknown.hpp"
#include "studio/base/dumped.hpp"
#include "studio/search/goal_task.hpp"
#include "studio/server/request_reading.hpp"
#include "studio/server/studio.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

Response goal_inputs(Studio& studio, const Request&) {
    const auto built = studio.simulation().built();
    return built ? json_response(goal_inputs_json(*built)) : nothing_built();
}

Response unknowns(Studio& studio, const Request&) {
    const auto built = studio.simulation().built();
    if (!built) return nothing_built();
    Json list = Json::array();
    for (const sim::identify::Unknown& one : sim::identify::possible_unknowns(built->robot))
        list.push_back({{"key", one.key}, {"unit", one.unit}, {"value", one.value}, {"shown", one.shown(one.value)}});
    return json_response(dumped(list));
}

/// The robot as its files are now, built anew if one of them has changed: what meshes it again would else mesh another
/// one than the page shows.
std::shared_ptr<const Built> built_as_files_are(Studio& studio) {
    studio.look_at_files();
    return studio.simulation().wait_until_built() ? studio.simulation().built() : nullptr;
}

Response begin_goal(Studio& studio, const Request& request) {
    auto built = studio.simulation().built();
    if (!built) return nothing_built();
    const Result<GoalOrder> order = parse_goal_order(request.body);
    if (!order) return error_response(order.error());
    Result<sim::InverseTask> task = goal_task(*built, *order);
    if (!task) return error_response(task.error());
    return done(studio.search().find_inputs(std::move(built), std::move(*task)));
}

Response begin_identify(Studio& studio, const Request& request) {
    auto built = built_as_files_are(studio);
    if (!built) return nothing_built();
    Result<IdentifyOrder> order = parse_identify_order(request.body);
    if (!order) return error_response(order.error());
    return done(studio.search().identify(std::move(built), std::move(*order)));
}

Response begin_workspace(Studio& studio, const Request& request) {
    auto built = studio.simulation().built();
    if (!built) return nothing_built();
    const Result<WorkspaceOrder> order = parse_workspace_order(request.body);
    if (!order) return error_response(order.error());
    Result<sim::InverseTask> task = workspace_task(*built, *order);
    if (!task) return error_response(task.error());
    return done(studio.search().find_workspace(std::move(built), std::move(*task), *order));
}

Response begin_sweep(Studio& studio, const Request& request) {
    auto built = built_as_files_are(studio);
    if (!built) return nothing_built();
    Result<SweepOrder> order = parse_sweep_order(request.body);
    if (!order) return error_response(order.error());
    return done(studio.search().sweep(std::move(built), std::move(*order)));
}

Response begin_motion(Studio& studio, const Request&) {
    auto built = studio.simulation().built();
    if (!built) return nothing_built();
    return done(studio.search().run_motion(std::move(built)));
}

/// A whole number in a path; empty if invalid.
std::optional<std::size_t> index_in(const std::string& text) {
    std::size_t index = 0;
    return parse_all(text, index) ? std::optional(index) : std::nullopt;
}

Response motion_frame(Studio& studio, const Request& request) {
    const auto found = studio.search().result();
    const std::optional<std::size_t> step = index_in(request.parts.at("step"));
    if (!found || !found->motion || !step || *step >= found->motion->count())
        return error_response(404, "there is no such step");
    const std::string field = asked_for(request, "field");
    std::set<std::string> fields;
    if (view::is_field(field)) fields.insert(field);
    return {200, "application/octet-stream", found->motion->frame(*step, fields)};
}

Response result(Studio& studio, const Request&) {
    const auto found = studio.search().result();
    return json_response(found ? found->json : "{}");
}

Response plot(Studio& studio, const Request& request) {
    const auto found = studio.search().result();
    const std::optional<std::size_t> index = index_in(request.parts.at("plot"));
    if (!found || !index || *index >= found->plots.size()) return error_response(404, "there is no such plot");
    return {200, "image/png", found->plots[*index].png};
}

}  // namespace

void add_search_routes(std::vector<Route>& routes) {
    const std::string json = "application/json";
    routes.push_back(
        {"GET", "/api/goal/inputs", "actuators that a goal may move, with their ranges", json, false, goal_inputs});
    routes.push_back(
        {"POST", "/api/goal", "looks for inputs that bring a marker along a path", json, true, begin_goal, json});
    routes.push_back(
        {"GET", "/api/unknowns", "parameters of the robot that measurements could identify", json, false, unknowns});
    routes.push_back({"POST", "/api/identify", "looks for parameters with which the program follows measurements", json,
                      true, begin_identify, json});
    routes.push_back({"POST", "/api/workspace", "looks for the places that the markers can get to", json, true,
                      begin_workspace, json});
    routes.push_back({"POST", "/api/sweep", "runs the program with one or two numbers over their ranges", json, true,
                      begin_sweep, json});
    routes.push_back({"POST", "/api/motion", "runs the whole program, to be played", json, true, begin_motion});
    routes.push_back({"GET", "/api/motion/{step}", "a state of it, from 0; ?field= one that is wanted",
                      "application/octet-stream", false, motion_frame});
    routes.push_back({"POST", "/api/search/cancel", "ends the search", json, true, [](Studio& s, const Request&) {
                          s.search().cancel();
                          return json_response("{}");
                      }});
    routes.push_back(
        {"GET", "/api/search", "what the last search has found; {} before there is one", json, false, result});
    routes.push_back(
        {"GET", "/api/search/plots/{plot}", "measured beside simulated values, from 0", "image/png", false, plot});
}

}  // namespace pliant::studio
