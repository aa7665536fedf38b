// Processes that run rows side by side, and are replaced when one dies.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "loop/study/record.hpp"

namespace pliant::study {

/// How a process that serves rows (worker.hpp) is started; its socket is its standard input.
struct WorkerProgram {
    std::filesystem::path program;
    std::vector<std::string> words;
};

/// A row as a process is given it.
struct RowOrder {
    std::size_t row = 0;
    std::vector<std::string> words;
    std::string folder;  ///< made for it; "": none
};

struct PoolOptions {
    WorkerProgram worker;
    std::vector<std::string> paths;  ///< of the numbers that are wanted of each row
    std::filesystem::path folder;    ///< in which the processes work
    int jobs = 1;                    ///< rows at a time, at least 1
    double row_limit_s = 0;          ///< wall time; 0: none
    int tries = 3;  ///< a row whose process was killed by somebody (SIGKILL) is run again so often in all
};

/// What the pool asks and tells; called from the thread that runs it.
struct PoolCalls {
    std::function<Result<std::optional<RowOrder>>()> next;  ///< nothing: there are no more
    std::function<Status(std::size_t)> begun;
    std::function<Status(const RowRecord&)> ended;  ///< its error ends the work
    std::function<Status(std::size_t)> given_up;    ///< cancelled while it ran
    std::function<void()> look;                     ///< now and then: progress
};

/// Runs rows until there are no more. A process that crashes, or takes longer than the limit, is the failure of its row
/// alone. Returns the processor time of all processes that were started, s. Errors: a process cannot be started; those
/// of the calls; cancellation, after all processes have ended.
[[nodiscard]] Result<double> run_pool(const PoolOptions& options, const PoolCalls& calls, const Progress& progress);

}  // namespace pliant::study
