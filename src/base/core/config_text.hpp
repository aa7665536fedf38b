// Writes a tree of values as TOML: without comments, with nested tables inline.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/core/config.hpp"

namespace pliant::config {

/// Parses back to the same tree. Precondition: the root is a Table.
[[nodiscard]] std::string toml_text(const Value& root);

/// A text in quotes; control characters are escaped.
[[nodiscard]] std::string toml_string(std::string_view text);
/// A key: bare, or quoted if necessary.
[[nodiscard]] std::string key_text(std::string_view key);

/// The parts of a path as in `--set`, which dots separate; a part in quotes may hold dots, as in
/// body."finger v1.2".material.
[[nodiscard]] std::vector<std::string> path_parts(std::string_view path);
/// One part of a path: as it is, or in quotes if path_parts() would take it for another.
[[nodiscard]] std::string path_part(std::string_view name);

}  // namespace pliant::config
