// Edits of the robot file other than typing: numbers, entries; and checks of a typed text.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"
#include "base/core/toml_edit.hpp"
#include "robot/file/material_library.hpp"
#include "studio/base/dumped.hpp"
#include "studio/server/based_text.hpp"
#include "studio/server/json_toml.hpp"
#include "studio/server/request_reading.hpp"
#include "studio/server/studio.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

Response set_values(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"changes", BodyKey::Kind::any}, {"text"}}); !known)
        return error_response(known.error());
    const Json json = parse_json(request.body);
    if (Status list = check_changes(json); !list) return error_response(list.error());
    for (const Json& change : json["changes"]) {
        if (!change.is_object() || !change.contains("key") || !change["key"].is_string() || !change.contains("value"))
            return error_response(422, "changes: key and value of each are needed");
    }
    return done(studio.edit_by([&](const std::string& text) {
        Result<std::string> next = json.contains("text") ? json["text"].get<std::string>() : text;
        for (const Json& change : json["changes"]) {
            next = with_robot_value(*next, change["key"].get<std::string>(), toml_text(change["value"]));
            if (!next) break;
        }
        return next;
    }));
}

Response add_entry(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"list"}, {"entry", BodyKey::Kind::any}}); !known)
        return error_response(known.error());
    const auto json = parse_ordered_json(request.body);
    if (!json.is_object() || !json.contains("list") || !json["list"].is_string() || !json.contains("entry") ||
        !json["entry"].is_object() || json["entry"].empty())
        return error_response(422, "list and entry are needed: its keys and their values");
    config::EntryText entry;
    for (const auto& [key, value] : json["entry"].items()) entry.emplace_back(key, toml_text(Json(value)));
    return done(studio.edit_by(
        [&](const std::string& text) { return with_robot_entry(text, json["list"].get<std::string>(), entry); }));
}

Response open_new(Studio& studio, const Request& request) {
    return done(studio.open_new(request.body, asked_for(request, "name")));
}

Response check(Studio& studio, const Request& request) {
    const Status status = studio.check(request.body);
    return json_response(fmt::format(R"({{"lines":{}}})", status ? "[]" : problem_lines(status.error())));
}

Response materials(Studio&, const Request&) {
    Json list = Json::array();
    for (const EmbeddedFile& file : robot::library_files()) {
        const auto material = robot::library_material(file.name);
        if (material)
            list.push_back({{"name", file.name}, {"title", material->title}, {"hardness", material->hardness}});
    }
    return json_response(dumped(list));
}

}  // namespace

void add_edit_routes(std::vector<Route>& routes) {
    const std::string json = "application/json";
    routes.push_back({"POST", "/api/robot/set",
                      "{\"changes\": [{\"key\", \"value\"}, ...]}: values of the robot file, all else as it was, or "
                      "as in its new \"text\"",
                      json, true, set_values, json});
    routes.push_back({"POST", "/api/robot/add", "{\"list\", \"entry\"}: one more entry, as of [[marker]]", json, true,
                      add_entry, json});
    routes.push_back({"POST", "/api/robot/new",
                      "a robot that is in no file of the folder yet, by its text; ?name= of the file it came from",
                      json, true, open_new, "text/plain"});
    routes.push_back({"POST", "/api/robot/check", "what is wrong with a robot file, by line; nothing is built", json,
                      true, check, "text/plain"});
    routes.push_back({"GET", "/api/materials", "the library of materials", json, false, materials});
}

}  // namespace pliant::studio
