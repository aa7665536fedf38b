// JSON as the pages get it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/core/json.hpp"

namespace pliant::studio {

/// On one line; bytes that are not UTF-8, as in the name of a file, are replaced.
[[nodiscard]] inline std::string dumped(const nlohmann::json& json) {
    return json_text(json);
}

}  // namespace pliant::studio
