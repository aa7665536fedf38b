// Writes a tree of values as TOML: without comments, with nested tables inline.
#pragma once

#include <string>

#include "base/core/config.hpp"

namespace pliant::config {

/// Parses back to the same tree. Precondition: the root is a Table.
[[nodiscard]] std::string toml_text(const Value& root);

}  // namespace pliant::config
