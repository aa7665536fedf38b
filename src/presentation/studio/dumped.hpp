// JSON as the pages get it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace pliant::studio {

/// On one line; bytes that are not UTF-8, as in the name of a file, are replaced.
[[nodiscard]] inline std::string dumped(const nlohmann::json& json) {
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace pliant::studio
