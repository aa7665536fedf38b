// The process that runs rows, many one after the other: what takes long to start is started once.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace pliant::study {

/// What a command did.
struct CommandOutcome {
    int exit_status = 0;
    std::string output;  ///< its standard output: JSON
    std::string errors;  ///< its standard error
};
/// Runs a command line, from the command's name on.
using RunCommand = std::function<CommandOutcome(const std::vector<std::string>& words)>;

/// Answers the rows that come over the socket `file`, until its other end closes. The study that started it is looked
/// for after each row, and the process ends with it. The exit status of the process.
[[nodiscard]] int serve_rows(int file, const RunCommand& run);

/// Runs `work`, which writes to standard output and error, and gives what it wrote. One at a time in a process.
[[nodiscard]] CommandOutcome captured(const std::function<int()>& work);

}  // namespace pliant::study
