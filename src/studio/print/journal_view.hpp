// Print journals as the page lists and shows them; docs/reference/journal.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::studio {

/// An entry of the list, JSON: `name`, `job`, `printer`, `state` ("complete", "cancelled", "interrupted", "not begun",
/// or "damaged" with `error`), `lights` (number of exposures), `layer` of the last (-1: none).
[[nodiscard]] std::string journal_line_json(const std::filesystem::path& file, const std::string& name);

/// The same with `records`: `number`, `kind`, `text`, the last 2000 of them, and `open_light`: an exposure whose end is
/// not in the journal. Errors: no such file, damaged.
[[nodiscard]] Result<std::string> journal_json(const std::filesystem::path& file, const std::string& name);

}  // namespace pliant::studio
