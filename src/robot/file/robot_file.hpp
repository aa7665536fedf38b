// Reads robot files. docs/reference/robot.md describes every key.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// Reads and validates; `assignments` are `KEY=VALUE` as of `--set`. An error holds one line per problem, each with
/// file and line.
[[nodiscard]] Result<Robot> load_robot(const std::filesystem::path& file,
                                       const std::vector<std::string>& assignments = {});
[[nodiscard]] Result<Robot> parse_robot(std::string_view text, const std::filesystem::path& file,
                                        const std::vector<std::string>& assignments = {});

}  // namespace pliant::robot
