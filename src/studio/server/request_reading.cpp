#include "studio/server/request_reading.hpp"

#include <cmath>
#include <filesystem>
#include <system_error>

#include "base/core/json.hpp"
#include "printing/screen/projector.hpp"
#include "studio/base/limits.hpp"
#include "studio/requests/project_folder.hpp"

namespace pliant::studio {

using Json = nlohmann::json;

std::string asked_for(const Request& request, const char* key, const char* otherwise) {
    const auto found = request.query.find(key);
    return found == request.query.end() ? otherwise : found->second;
}

std::string text_at(const Json& json, const char* key) {
    return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
}

std::string body_text(const Request& request, const char* key) {
    return text_at(parse_json(request.body), key);
}

double number_at(const Json& json, const char* key, double otherwise) {
    return json.is_object() && json.contains(key) && json[key].is_number() ? json[key].get<double>() : otherwise;
}

Result<int> whole_at(const Json& json, const char* key, int otherwise, int most) {
    const double number = number_at(json, key, otherwise);
    if (number >= 1 && number <= most && number == std::floor(number)) return static_cast<int>(number);
    return input_error("{}: a whole number from 1 to {} is needed", key, most);
}

Status check_changes(const Json& json) {
    if (json.is_object() && json.contains("changes") && json["changes"].is_array() && !json["changes"].empty() &&
        json["changes"].size() <= most_changes)
        return {};
    return input_error("changes: a list of 1 to {} is needed, each with key and value", most_changes);
}

Result<std::string> projector_place(const ProjectFolder& folder, const std::string& where) {
    if (host::display_number(where)) return where;
    const Result<std::filesystem::path> path = folder.resolve(where);
    if (!path) return input_error("projector: {}", path.error().message);
    std::error_code error;
    std::filesystem::create_directories(*path, error);
    if (error) return failure("projector: {}: {}", path->string(), error.message());
    return path->string();
}

Response nothing_built() {
    return error_response(404, "no robot has been built yet");
}

}  // namespace pliant::studio
