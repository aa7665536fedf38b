#include "studio/server/json_toml.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/core/config_text.hpp"

namespace pliant::studio {

using Json = nlohmann::json;

std::string toml_text(const Json& value) {
    if (value.is_string() || value.is_boolean() || value.is_number_integer())
        return value.dump(-1, ' ', true, Json::error_handler_t::replace);
    if (value.is_number()) return fmt::format("{:.10g}", value.get<double>());
    std::string inner;
    if (value.is_array()) {
        for (const Json& item : value) inner += (inner.empty() ? "" : ", ") + toml_text(item);
        return "[" + inner + "]";
    }
    if (!value.is_object()) return "";
    for (const auto& [key, item] : value.items())
        inner += fmt::format("{}{} = {}", inner.empty() ? "" : ", ", config::key_text(key), toml_text(item));
    return "{ " + inner + " }";
}

}  // namespace pliant::studio
