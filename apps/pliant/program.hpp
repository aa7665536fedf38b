// The program as a function: what main() does with its words.
#pragma once

#include <string>
#include <vector>

namespace pliant::app {

/// Runs a command line, without the program's name, and gives its exit status.
int run_program(const std::vector<std::string>& words);

/// The commands that give --json and end by themselves: what a study may run.
[[nodiscard]] std::vector<std::string> commands_of_studies();

}  // namespace pliant::app
