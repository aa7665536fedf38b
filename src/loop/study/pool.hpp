// A pool of processes that run rows in parallel and are replaced when they die.
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

/// How to start a process that serves rows (worker.hpp); its socket is its standard input.
struct WorkerProgram {
    std::filesystem::path program;
    std::vector<std::string> words;
};

/// A row as sent to a process.
struct RowOrder {
    std::size_t row = 0;
    std::vector<std::string> words;
    std::string folder;  ///< made for the row; "": none
};

struct PoolOptions {
    WorkerProgram worker;
    std::vector<std::string> paths;  ///< of the wanted numbers of each row
    std::filesystem::path folder;    ///< working directory of the processes
    int jobs = 1;                    ///< number of parallel rows, at least 1
    double row_limit_s = 0;          ///< wall time; 0: none
    int tries = 3;  ///< a row whose process was killed from outside (SIGKILL) is run at most this many times
};

/// Callbacks of the pool; called from the thread that runs it.
struct PoolCalls {
    std::function<Result<std::optional<RowOrder>>()> next;  ///< nothing: no more rows
    std::function<Status(std::size_t)> begun;
    std::function<Status(const RowRecord&)> ended;  ///< an error ends the work
    std::function<Status(std::size_t)> given_up;    ///< the row was cancelled while it ran
    std::function<void()> look;                     ///< called regularly: progress
};

/// Runs rows until there are none left. A process that crashes or exceeds the time limit fails its own row only.
/// Returns the processor time of all processes started, s. Errors: a process cannot be started; those of the callbacks;
/// cancellation, once all processes have ended.
[[nodiscard]] Result<double> run_pool(const PoolOptions& options, const PoolCalls& calls, const Progress& progress);

}  // namespace pliant::study
