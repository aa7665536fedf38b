// What routes read from requests: queries, and values of JSON bodies.
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>

#include "base/core/error.hpp"
#include "studio/base/http.hpp"

namespace pliant::studio {

class ProjectFolder;

/// The value of ?key= ; `otherwise` if it is missing.
[[nodiscard]] std::string asked_for(const Request& request, const char* key, const char* otherwise = "");

/// A key that the JSON body of a request may have, or must.
struct BodyKey {
    enum class Kind { text, number, flag, any };
    const char* name;
    Kind kind = Kind::text;
    bool required = false;
};
/// Errors, which name the key: one of the body that is not among these, a value of another kind, a required one that is
/// missing. An empty body has no keys.
[[nodiscard]] Status check_body(const Request& request, std::initializer_list<BodyKey> keys);

/// The text under `key`; "" if there is none.
[[nodiscard]] std::string text_at(const nlohmann::json& json, const char* key);
/// The text under `key` in the JSON body; "" if there is none.
[[nodiscard]] std::string body_text(const Request& request, const char* key);
[[nodiscard]] double number_at(const nlohmann::json& json, const char* key, double otherwise);
/// Errors: a number that is not whole, or not from 1 to `most`.
[[nodiscard]] Result<int> whole_at(const nlohmann::json& json, const char* key, int otherwise, int most);

/// Error: "changes" of a request is not a list of 1 to most_changes.
[[nodiscard]] Status check_changes(const nlohmann::json& json);

/// Where a projector shows: the number of a display, or a folder of the project, which is made.
[[nodiscard]] Result<std::string> projector_place(const ProjectFolder& folder, const std::string& where);

/// 404: no robot has been built yet.
[[nodiscard]] Response nothing_built();

}  // namespace pliant::studio
