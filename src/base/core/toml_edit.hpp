// Changes one value of a TOML text and preserves everything else: comments, order, spaces.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::config {

/// `text` with the value at `path` replaced, or added if missing. `path` is as in `--set`: keys separated by dots,
/// entries of a [[list]] by their `name` ("cable.flexor.friction") or index ("cable.0.friction", "cable[0].friction"),
/// names with dots in quotes (body."finger v1.2".material). `value` is TOML.
/// Errors: the text or the value is not TOML, the path leads through a value or to a missing entry.
[[nodiscard]] Result<std::string> with_value(std::string_view text, std::string_view path, std::string_view value);

/// Keys of an entry, and their values in TOML.
using EntryText = std::vector<std::pair<std::string, std::string>>;

/// `text` with an entry appended to a top-level list, as [[list]], or as an inline table if the list is an inline
/// array. Errors as above; also if `list` is not a list.
[[nodiscard]] Result<std::string> with_entry(std::string_view text, std::string_view list, const EntryText& entry);

}  // namespace pliant::config
