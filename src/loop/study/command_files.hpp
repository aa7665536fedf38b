// The files that the command of a study reads.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "loop/study/plan.hpp"

namespace pliant::study {

/// The files that a word of the command names: FILE, --x=FILE or NAME=FILE, and the robots that such a file stands on.
[[nodiscard]] std::vector<std::filesystem::path> files_of(const std::string& word, const std::filesystem::path& folder);

/// All files that any row reads, each once: those that a word of the command names, in braces too, those from which
/// such a robot is read (meshes, geometry, tables), and those that a key, or --set in the command, names in their
/// place. Cost: that of a row times their number where a key has texts or stands in a word.
[[nodiscard]] std::vector<std::filesystem::path> files_of(const Plan& plan);

}  // namespace pliant::study
