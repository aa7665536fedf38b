#include "studio/server/request_reading.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/core/json.hpp"
#include "base/core/letters.hpp"
#include "base/core/text.hpp"
#include "printing/screen/projector.hpp"
#include "studio/base/limits.hpp"
#include "studio/requests/project_folder.hpp"

namespace pliant::studio {

using Json = nlohmann::json;

namespace {

bool is_of_kind(const Json& value, BodyKey::Kind kind) {
    switch (kind) {
        case BodyKey::Kind::text:
            return value.is_string();
        case BodyKey::Kind::number:
            return value.is_number();
        case BodyKey::Kind::flag:
            return value.is_boolean();
        default:
            return true;
    }
}

std::string_view words_for(BodyKey::Kind kind) {
    switch (kind) {
        case BodyKey::Kind::text:
            return "a text";
        case BodyKey::Kind::number:
            return "a number";
        case BodyKey::Kind::flag:
            return "true or false";
        default:
            return "a value";
    }
}

}  // namespace

Status check_body(const Request& request, std::initializer_list<BodyKey> keys) {
    const Json parsed = parse_json(request.body);
    const Json body = parsed.is_object() ? parsed : Json::object();
    for (const auto& given : body.items()) {
        const std::string& name = given.key();
        if (std::ranges::any_of(keys, [&](const BodyKey& key) { return key.name == name; })) continue;
        std::vector<std::string> names;
        for (const BodyKey& key : keys) names.emplace_back(key.name);
        return input_error("{}: there is no such key; this request takes {}", one_line(name), join_names(names));
    }
    for (const BodyKey& key : keys) {
        const auto found = body.find(key.name);
        if (found == body.end() ? key.required : !is_of_kind(*found, key.kind))
            return input_error("{}: {} is needed", key.name, words_for(key.kind));
    }
    return {};
}

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
