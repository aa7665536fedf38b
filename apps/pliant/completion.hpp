// Scripts for bash, zsh and fish that complete command lines.
#pragma once

#include <string>

#include "command_table.hpp"

namespace pliant::app {

[[nodiscard]] std::string bash_completion(const CommandEntry& program);
[[nodiscard]] std::string zsh_completion(const CommandEntry& program);
[[nodiscard]] std::string fish_completion(const CommandEntry& program);

/// Every command except the program itself, including subcommands, in order.
[[nodiscard]] std::vector<const CommandEntry*> all_commands(const CommandEntry& program);

/// True if the value may be a file name.
[[nodiscard]] bool takes_files(const OptionEntry& entry);

}  // namespace pliant::app
