// The study file: TOML that defines a command and the values it is run with. docs/reference/study.md lists its keys.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "loop/study/plan.hpp"

namespace pliant::study {

/// The commands that a study may run, and the calling program.
struct StudyContext {
    std::span<const std::string> commands;  ///< that have --json
    std::string version;                    ///< of the program
};

/// The plan in a study file, with all its rows. Files that the command names are resolved relative to the study file;
/// they and the table are part of the fingerprint. Errors name file, line and key: an unknown key with the nearest one,
/// an empty range, an unreadable path, a grid of over most_rows, a table with an empty cell.
[[nodiscard]] Result<Plan> load_study(const std::filesystem::path& file, const StudyContext& context);

/// The same for a text as the content of `file`. Reads the table and the files that the command names.
[[nodiscard]] Result<Plan> parse_study(std::string_view text, const std::filesystem::path& file,
                                       const StudyContext& context);

}  // namespace pliant::study
