// A tree of values as TOML again: without comments and with tables inside tables in one line each.
#pragma once

#include <string>

#include "base/core/config.hpp"

namespace pliant::config {

/// Reads back as the same tree. Precondition: the root is a Table.
[[nodiscard]] std::string toml_text(const Value& root);

}  // namespace pliant::config
