// Writes a tree of values as TOML: without comments, with nested tables inline.
#pragma once

#include <string>
#include <string_view>

#include "base/core/config.hpp"

namespace pliant::config {

/// Parses back to the same tree. Precondition: the root is a Table.
[[nodiscard]] std::string toml_text(const Value& root);

/// A text in quotes; control characters are escaped.
[[nodiscard]] std::string toml_string(std::string_view text);
/// A key: bare, or quoted if necessary.
[[nodiscard]] std::string key_text(std::string_view key);

}  // namespace pliant::config
