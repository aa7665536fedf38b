// Programs of the cluster, asked for something: sbatch, squeue, scancel.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"

namespace pliant::study {

struct ToolOutcome {
    int status = 0;  ///< exit status; -1: it was killed
    std::string output, errors;
};

/// Runs a program of PATH to its end, or `limit_s`. Errors: it is not there, cannot be started, was ended because it
/// took longer; cancellation.
[[nodiscard]] Result<ToolOutcome> run_tool(const std::string& name, const std::vector<std::string>& words,
                                           double limit_s, const Progress& progress);

}  // namespace pliant::study
