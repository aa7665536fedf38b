// pliant completion: scripts for shell completion, generated from the parser's own table.
#include "completion.hpp"

#include <fmt/format.h>

#include <memory>

#include "command.hpp"

namespace pliant::app {

std::vector<const CommandEntry*> all_commands(const CommandEntry& program) {
    std::vector<const CommandEntry*> all;
    for (const CommandEntry& entry : program.below) {
        all.push_back(&entry);
        for (const CommandEntry* below : all_commands(entry)) all.push_back(below);
    }
    return all;
}

bool takes_files(const OptionEntry& entry) {
    return entry.values > 0 && entry.open && entry.value == "TEXT";
}

void add_completion(CLI::App& app, int& status) {
    CLI::App* command = app.add_subcommand("completion", "print the completion script of a shell");
    command->group("");  // hidden: only for packages and shell profiles
    auto shell = std::make_shared<std::string>();
    command->add_option("shell", *shell, "bash, zsh or fish; json: the table of all commands and options")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh", "fish", "json"}));
    command->footer("Example: pliant completion bash > ~/.local/share/bash-completion/completions/pliant");
    on_call(*command, status, [shell, &app]() -> Status {
        const CommandEntry table = command_table(app);
        fmt::print("{}", *shell == "bash"   ? bash_completion(table)
                         : *shell == "zsh"  ? zsh_completion(table)
                         : *shell == "fish" ? fish_completion(table)
                                            : table_json(table) + "\n");
        return {};
    });
}

}  // namespace pliant::app
