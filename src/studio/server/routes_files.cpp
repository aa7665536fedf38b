// Geometry files uploaded into the folder, and thumbnails of the robots that can be opened.
#include <nlohmann/json.hpp>

#include "base/core/files.hpp"
#include "printing/job/job.hpp"
#include "studio/base/dumped.hpp"
#include "studio/base/limits.hpp"
#include "studio/built_in/examples.hpp"
#include "studio/files/received_file.hpp"
#include "studio/server/request_reading.hpp"
#include "studio/server/studio.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

Json vector_json(const Vec3& v) {
    return Json::array({v.x, v.y, v.z});
}

std::string content_json(const std::string& name, const GeometryContent& content) {
    const Json json = {{"name", name},
                       {"kind", content.kind},
                       {"unit_mm", content.unit_mm},
                       {"low", vector_json(content.box.low)},
                       {"high", vector_json(content.box.high)},
                       {"text", content.text},
                       {"parts", content.parts},
                       {"notes", content.notes}};
    return dumped(json);
}

Response receive(Studio& studio, const Request& request) {
    if (!request.more) return error_response(422, "the file is needed as the body of the request");
    const std::string name = asked_for(request, "name");
    const auto received =
        receive_geometry(studio.folder(), name, asked_for(request, "replace") == "1", request.length, request.more);
    if (!received) return error_response(received.error());
    if (received->how == Received::name_is_taken)
        return error_response(409, name + ": a file of this name is there already, with other content");
    studio.look_at_files();
    return json_response(content_json(name, received->content));
}

Response picture(Studio& studio, const std::string& text, const std::filesystem::path& file) {
    const std::shared_ptr<const std::string> png = studio.thumbnails().of(text, file, studio.folder());
    if (!png) return error_response(404, "there is no picture of it");
    return {200, "image/png", *png};
}

/// The one that the slicer put into it.
Response picture_of_job(const std::filesystem::path& file) {
    const Result<job::Archive> job = job::Archive::open(file);
    if (!job) return error_response(404, job.error().message);
    Result<std::string> png = job->file(job::thumbnail_file);
    if (!png) return error_response(404, png.error().message);
    return {200, "image/png", std::move(*png)};
}

Response thumbnail(Studio& studio, const Request& request) {
    const std::string example = asked_for(request, "example"), name = asked_for(request, "file");
    if (!example.empty()) {
        const EmbeddedFile* found = find_file(example_robots(), example);
        if (found == nullptr) return error_response(404, "there is no such example");
        return picture(studio, std::string(found->text), studio.folder().path() / (example + ".toml"));
    }
    const Result<std::filesystem::path> path = studio.folder().resolve(name);
    if (!path) return error_response(path.error());
    if (lower_extension(*path) == ".zip") return picture_of_job(*path);
    if (lower_extension(*path) != ".toml")
        return error_response(404, "there are pictures of robot files and jobs only");
    const Result<std::string> text = read_file(*path, largest_robot);
    return text ? picture(studio, *text, *path) : error_response(404, text.error().message);
}

Response first_picture(Studio& studio, const Request& request) {
    const std::shared_ptr<const std::string> png = studio.first_picture(asked_for(request, "theme") == "dark");
    return png ? Response{200, "image/png", *png} : Response{204, "image/png", ""};
}

}  // namespace

void add_file_routes(std::vector<Route>& routes) {
    routes.push_back({"PUT", "/api/files",
                      "a file of geometry for the folder, ?name= and replace=1 to write over another: read by its "
                      "reader, then put there; answers what it holds",
                      "application/json", true, receive, "application/octet-stream", true});
    routes.push_back({"GET", "/api/thumbnail", "a small picture of a robot or a job, ?example= or ?file=", "image/png",
                      false, thumbnail});
    routes.push_back(
        {"GET", "/api/picture",
         "the robot as drawn, before it is built; theme=dark for a dark background; 204 without content if "
         "there is none",
         "image/png", false, first_picture});
}

}  // namespace pliant::studio
