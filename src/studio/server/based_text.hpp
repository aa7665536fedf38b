// Changes of a robot file's text that may stand on another file (robot = "FILE.toml"): such a file holds a list `set`
// of "KEY=VALUE" and a program, and nothing else.
#pragma once

#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "base/core/toml_edit.hpp"

namespace pliant::studio {

/// As config::with_value(). In a file that stands on another one, values outside of its program go into `set`, where
/// one of the same key is replaced.
[[nodiscard]] Result<std::string> with_robot_value(std::string_view text, std::string_view key, std::string_view value);

/// As config::with_entry(); an error, too, for a file that stands on another one, unless it is an entry of its program.
[[nodiscard]] Result<std::string> with_robot_entry(std::string_view text, std::string_view list,
                                                   const config::EntryText& entry);

}  // namespace pliant::studio
