// Other programs, started by this one.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/core/error.hpp"

namespace pliant {

/// What becomes standard input, output and error of a new process; below zero: /dev/null.
struct ProcessFiles {
    int input = -1;
    int output = -1;
    int error = -1;
};

/// Starts a program, without a search in PATH; `words` are its arguments without the program's name. It runs in a
/// session of its own, so that a key such as Ctrl-C that ends this program does not end it, and blocks no signal. The
/// caller waits for the process (waitpid). Errors: the program and what the system said.
[[nodiscard]] Result<pid_t> start_process(const std::filesystem::path& program, std::vector<std::string> words,
                                          const ProcessFiles& files);

}  // namespace pliant
