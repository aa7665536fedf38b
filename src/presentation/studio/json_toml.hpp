// A value that a page sends, as it is written into a TOML file.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace pliant::studio {

/// On one line; "" for null, which TOML has not.
[[nodiscard]] std::string toml_text(const nlohmann::json& value);

}  // namespace pliant::studio
