// The program as a function: everything that main() does.
#pragma once

#include <string>
#include <vector>

namespace pliant::app {

/// Runs a command line, given without the program's name, and returns its exit status.
int run_program(const std::vector<std::string>& words);

/// The commands that support --json and end by themselves: those that a study may run.
[[nodiscard]] std::vector<std::string> commands_of_studies();

}  // namespace pliant::app
