// Converts a value sent by a page to TOML.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace pliant::studio {

/// On one line; "" for null, which TOML lacks.
[[nodiscard]] std::string toml_text(const nlohmann::json& value);

}  // namespace pliant::studio
