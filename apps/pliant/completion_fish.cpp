#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/core/process.hpp"
#include "completion.hpp"

namespace pliant::app {
namespace {

/// True if the words before the cursor name exactly this command.
constexpr const char* fish_head = R"(# fish completion for pliant, written by "pliant completion fish"
function __pliant_at
    set -l command
    for word in (commandline -opc)[2..-1]
        set -l longer (string join -- ' ' $command $word)
        contains -- $longer $__pliant_commands; and set command $longer
    end
    test "$command" = "$argv[1]"
end
complete -c pliant -f
)";

std::string at(const std::string& command) {
    return in_shell_quotes("__pliant_at " + in_shell_quotes(command));
}

std::string words_of(const std::vector<std::string>& words) {
    return in_shell_quotes(fmt::format("{}", fmt::join(words, " ")));
}

std::string option_line(const CommandEntry& command, const OptionEntry& option) {
    std::string line = fmt::format("complete -c pliant -n {}", at(command.name));
    for (const std::string& name : option.names)
        line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (option.values > 0) {
        line += takes_files(option) ? " -r -F" : " -x";
        if (!option.choices.empty()) line += " -a " + words_of(option.choices);
    }
    return line + " -d " + in_shell_quotes(option.help) + "\n";
}

std::string command_lines(const CommandEntry& command) {
    std::string text;
    for (const OptionEntry& option : command.options) text += option_line(command, option);
    for (const CommandEntry& below : command.below)
        text += fmt::format("complete -c pliant -n {} -a {} -d {}\n", at(command.name),
                            below.name.substr(below.name.rfind(' ') + 1), in_shell_quotes(below.help));
    for (const OptionEntry& argument : command.arguments) {
        if (!argument.choices.empty())
            text += fmt::format("complete -c pliant -n {} -a {}\n", at(command.name), words_of(argument.choices));
        if (takes_files(argument)) text += fmt::format("complete -c pliant -n {} -F\n", at(command.name));
    }
    return text;
}

}  // namespace

std::string fish_completion(const CommandEntry& program) {
    std::string text = "set -g __pliant_commands";
    for (const CommandEntry* command : all_commands(program)) text += " " + in_shell_quotes(command->name);
    text += "\n";
    text += fish_head + command_lines(program);
    for (const CommandEntry* command : all_commands(program)) text += command_lines(*command);
    return text;
}

}  // namespace pliant::app
