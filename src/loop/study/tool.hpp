// Runs programs of the cluster: sbatch, squeue, scancel.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"

namespace pliant::study {

struct ToolOutcome {
    int status = 0;  ///< exit status; -1: killed
    std::string output, errors;
};

/// Runs a program found on PATH for at most `limit_s`. Errors: not found, cannot be started, killed because it took
/// longer; cancellation.
[[nodiscard]] Result<ToolOutcome> run_tool(const std::string& name, const std::vector<std::string>& words,
                                           double limit_s, const Progress& progress);

}  // namespace pliant::study
