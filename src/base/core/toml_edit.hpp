// Changes one thing of a TOML text and leaves all else as a person wrote it: comments, order, spaces.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::config {

/// `text` with the value at `path` replaced, or added where it is not there yet. `path` as that of `--set`: keys with
/// dots between them, entries of a [[list]] by their `name` ("cable.flexor.friction") or their number. `value` is TOML.
/// Errors: the text or the value is no TOML, the path leads through a value or to an entry that is not there.
[[nodiscard]] Result<std::string> with_value(std::string_view text, std::string_view path, std::string_view value);

/// Keys of an entry, and their values in TOML.
using EntryText = std::vector<std::pair<std::string, std::string>>;

/// `text` with one more entry at the end of a top-level list: as [[list]], or in brackets where the list is written so.
/// Errors as above; `list` is something else.
[[nodiscard]] Result<std::string> with_entry(std::string_view text, std::string_view list, const EntryText& entry);

/// A key as TOML has it: bare, or in quotes.
[[nodiscard]] std::string key_text(std::string_view key);

}  // namespace pliant::config
