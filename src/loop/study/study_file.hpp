// The study file: TOML that says which command is run with which values. docs/reference/study.md lists its keys.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "loop/study/plan.hpp"

namespace pliant::study {

/// What a study may run, and who asks.
struct StudyContext {
    std::span<const std::string> commands;  ///< that give --json
    std::string version;                    ///< of the program
};

/// The plan that a study file asks for, with all its rows. Files that the command names are looked up beside the study
/// file; they and the table go into the fingerprint. Errors name file, line and key: an unknown key with the nearest
/// one, an empty range, a path that cannot be read, a grid of over most_rows, a table with a hole.
[[nodiscard]] Result<Plan> load_study(const std::filesystem::path& file, const StudyContext& context);

/// The same of a text that would stand in `file`. Reads the table and the files that the command names.
[[nodiscard]] Result<Plan> parse_study(std::string_view text, const std::filesystem::path& file,
                                       const StudyContext& context);

}  // namespace pliant::study
