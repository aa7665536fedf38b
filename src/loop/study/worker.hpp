// The worker process, which runs many rows one after the other to save the start-up cost.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace pliant::study {

/// The result of a command.
struct CommandOutcome {
    int exit_status = 0;
    std::string output;  ///< its standard output: JSON
    std::string errors;  ///< its standard error
};
/// Runs a command line, from the command's name on.
using RunCommand = std::function<CommandOutcome(const std::vector<std::string>& words)>;

/// Runs rows received over the socket `file` until its other end closes. After each row it checks that the study that
/// started it still runs, and ends with it. Returns the exit status of the process.
[[nodiscard]] int serve_rows(int file, const RunCommand& run);

/// Runs `work`, which writes to standard output and error, and returns what it wrote. Only one at a time per process.
[[nodiscard]] CommandOutcome captured(const std::function<int()>& work);

}  // namespace pliant::study
