// What bash, zsh and fish load to complete the words of a command line.
#pragma once

#include <string>

#include "command_table.hpp"

namespace pliant::app {

[[nodiscard]] std::string bash_completion(const CommandEntry& program);
[[nodiscard]] std::string zsh_completion(const CommandEntry& program);
[[nodiscard]] std::string fish_completion(const CommandEntry& program);

/// Text in single quotes, as all three shells read it.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// Every command but the program itself, those below others too, in order.
[[nodiscard]] std::vector<const CommandEntry*> all_commands(const CommandEntry& program);

/// Whether what is typed there may be the name of a file.
[[nodiscard]] bool takes_files(const OptionEntry& entry);

}  // namespace pliant::app
