// The folder of a workspace: table, surfaces, picture.
#pragma once

#include <filesystem>

#include "base/core/progress.hpp"
#include "presentation/report/workspace_files.hpp"
#include "robot/description/robot.hpp"

namespace pliant::report {

/// docs/reference/results.md lists the files. Errors: of the disk; cancelled.
[[nodiscard]] Status write_workspace(const std::filesystem::path& folder, const robot::Robot& robot,
                                     const WorkspaceReport& report, Progress& progress);

}  // namespace pliant::report
