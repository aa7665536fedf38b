// The files that the command of a study reads.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pliant::study {

/// The files that a word of the command names: FILE, --x=FILE or NAME=FILE, and the robot that such a file stands on.
[[nodiscard]] std::vector<std::filesystem::path> files_of(const std::string& word, const std::filesystem::path& folder);

}  // namespace pliant::study
