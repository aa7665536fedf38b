// Files: the robot file as text, saving, undo, and the contents of the folder.
#include <nlohmann/json.hpp>

#include "base/core/files.hpp"
#include "base/core/json.hpp"
#include "printing/machine/built_in_printers.hpp"
#include "studio/base/dumped.hpp"
#include "studio/built_in/examples.hpp"
#include "studio/server/request_reading.hpp"
#include "studio/server/studio.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

/// Adds the printer files of the folder: other TOML files have no projector.
void add_own_printers(const ProjectFolder& folder, Json& printers) {
    constexpr std::uintmax_t largest = 1 << 20;
    for (const std::string& name : folder.files()) {
        if (lower_extension(name) != ".toml") continue;
        const Result<std::string> text = read_file(folder.path() / name, largest);
        if (text && text->find("[projector]") != std::string::npos) printers.push_back(name);
    }
}

Response project(Studio& studio, const Request&) {
    const Studio::Document d = studio.document();
    Json examples = Json::array(), printers = Json::array();
    for (const EmbeddedFile& file : example_robots()) examples.push_back(file.name);
    for (const EmbeddedFile& file : machine::built_in_printers()) printers.push_back(file.name);
    add_own_printers(studio.folder(), printers);
    const Json json = {
        {"version", studio.version()},      {"name", d.name},       {"folder", studio.folder().path().string()},
        {"files", studio.folder().files()}, {"examples", examples}, {"printers", printers},
        {"webcam", studio.webcam()}};
    return json_response(dumped(json));
}

Response robot_text(Studio& studio, const Request&) {
    return {200, "text/plain; charset=utf-8", studio.document().text};
}

Response save_robot(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"name"}, {"overwrite", BodyKey::Kind::flag}}); !known)
        return error_response(known.error());
    const Json json = parse_json(request.body);
    const bool overwrite = json.is_object() && json.value("overwrite", false);
    const Result<Studio::Saved> saved = studio.save(text_at(json, "name"), overwrite);
    if (!saved) return error_response(saved.error());
    if (*saved == Studio::Saved::done) return json_response("{}");
    const std::string name = studio.document().name;
    const std::string why = name + " has been changed elsewhere since it was opened here; nothing was written";
    return {409, "application/json", dumped({{"error", why}, {"changed", true}})};
}

Response set_accuracy(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"accuracy"}}); !known) return error_response(known.error());
    const std::optional<Accuracy> accuracy = accuracy_named(body_text(request, "accuracy"));
    if (!accuracy) return error_response(422, R"(accuracy: "preview", "automatic" or "fine" is needed)");
    studio.set_accuracy(*accuracy);
    return json_response("{}");
}

Response open_file(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"name"}}); !known) return error_response(known.error());
    const std::string name = body_text(request, "name");
    if (name.empty()) return error_response(422, "name: the name of a file is needed");
    return done(studio.open_file(name));
}

Response open_example(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"name"}}); !known) return error_response(known.error());
    const std::string name = body_text(request, "name");
    if (find_file(example_robots(), name) == nullptr) return error_response(404, "there is no such example");
    studio.open_example(name);
    return json_response("{}");
}

Response compare(Studio& studio, const Request& request) {
    if (Status known = check_body(request, {{"name"}, {"example"}}); !known) return error_response(known.error());
    return done(studio.compare(body_text(request, "name"), body_text(request, "example")));
}

Response scene_beside(Studio& studio, const Request&) {
    const auto second = studio.beside();
    const auto packet = second ? second->scene() : nullptr;
    if (!packet) return error_response(404, "there is no second robot, or it is not built yet");
    return {200, "application/octet-stream", *packet};
}

Response frame_beside(Studio& studio, const Request&) {
    const auto second = studio.beside();
    const auto packet = second ? second->last_frame() : nullptr;
    return {200, "application/octet-stream", packet ? *packet : ""};
}

}  // namespace

void add_project_routes(std::vector<Route>& routes) {
    const std::string json = "application/json", text = "text/plain";
    routes.push_back(
        {"GET", "/api/project", "the folder, its files, built-in examples and printers", json, false, project});
    routes.push_back({"GET", "/api/robot", "the robot file as it stands in the editor", text, false, robot_text});
    routes.push_back({"PUT", "/api/robot", "another text for the robot file: checked, built, shown", json, true,
                      [](Studio& s, const Request& r) { return done(s.edit(r.body)); }, text});
    routes.push_back({"POST", "/api/robot/undo", "the text before the last change", json, true,
                      [](Studio& s, const Request&) { return done(s.undo()); }});
    routes.push_back({"POST", "/api/robot/redo", "the change that was undone", json, true,
                      [](Studio& s, const Request&) { return done(s.redo()); }});
    routes.push_back({"POST", "/api/robot/save",
                      "writes the robot file; {\"name\"} for a new one; 409 with \"changed\" if the file was changed "
                      "elsewhere, unless {\"overwrite\": true}",
                      json, true, save_robot, json});
    routes.push_back(
        {"POST", "/api/open", "opens {\"name\"}, a robot file or job of the folder", json, true, open_file, json});
    routes.push_back(
        {"POST", "/api/example", "opens {\"name\"}, a robot that is built in", json, true, open_example, json});
    routes.push_back(
        {"POST", "/api/compare",
         "a second robot beside, driven by the same inputs: {\"name\"} of the folder, {\"example\"}, or {}: the "
         "robot as it stands now",
         json, true, compare, json});
    routes.push_back({"POST", "/api/compare/leave", "one robot again", json, true, [](Studio& s, const Request&) {
                          s.stop_comparing();
                          return json_response("{}");
                      }});
    routes.push_back({"GET", "/api/compare/scene", "what does not move of the second robot", "application/octet-stream",
                      false, scene_beside});
    routes.push_back({"GET", "/api/compare/frame", "the latest state of the second robot", "application/octet-stream",
                      false, frame_beside});
    routes.push_back(
        {"POST", "/api/accuracy",
         "{\"accuracy\": \"preview\"} for linear tets, \"fine\" for quadratic ones, \"automatic\" for linear ones "
         "while a hand moves",
         json, true, set_accuracy, json});
}

}  // namespace pliant::studio
