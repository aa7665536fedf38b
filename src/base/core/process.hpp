// Starting other programs.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/core/error.hpp"

namespace pliant {

/// Standard input, output and error of a new process; a negative number means /dev/null.
struct ProcessFiles {
    int input = -1;
    int output = -1;
    int error = -1;
};

/// Starts a program without searching PATH; `words` are its arguments without the program's name. It runs in a session
/// of its own, so a Ctrl-C that ends this program does not end it, and with no signal blocked. The caller must wait for
/// the process (waitpid). Errors: names the program and the system's reason.
[[nodiscard]] Result<pid_t> start_process(const std::filesystem::path& program, std::vector<std::string> words,
                                          const ProcessFiles& files);

}  // namespace pliant
