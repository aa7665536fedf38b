#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/core/process.hpp"
#include "completion.hpp"

namespace pliant::app {
namespace {

/// Escapes brackets and colons, which are separators in an _arguments specification.
std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
        out += c == '\n' ? ' ' : c;
    }
    return out;
}

/// "TEXT:action": description of the value, and how it is completed.
std::string value_of(const OptionEntry& entry, const std::string& name) {
    std::string action = " ";
    if (!entry.choices.empty() && entry.open)
        action = fmt::format("{{compadd {}; _files}}", fmt::join(entry.choices, " "));
    else if (!entry.choices.empty())
        action = fmt::format("({})", fmt::join(entry.choices, " "));
    else if (takes_files(entry))
        action = "_files";
    return fmt::format("{}:{}", escaped(name), action);
}

/// One line for each name of an option: using one of them excludes the others, unless it may be repeated.
std::string option_lines(const OptionEntry& option) {
    std::string text;
    for (const std::string& name : option.names) {
        std::string line = option.repeated ? "*" : fmt::format("({})", fmt::join(option.names, " "));
        line += name + "[" + escaped(option.help) + "]";
        for (int i = 0; i < option.values; ++i) line += ":" + value_of(option, option.value);
        text += " \\\n        " + in_shell_quotes(line);
    }
    return text;
}

std::string function_name(const CommandEntry& command) {
    std::string name = "_pliant";
    if (!command.name.empty()) name += "_" + command.name;
    for (char& c : name) c = c == ' ' || c == '-' ? '_' : c;
    return name;
}

std::string last_word(const std::string& name) {
    return name.substr(name.rfind(' ') + 1);  // npos + 1 is 0
}

/// Positional arguments: single ones, and those that may be repeated.
std::string argument_lines(const CommandEntry& command) {
    std::string text;
    int number = 0;
    for (const OptionEntry& argument : command.arguments) {
        ++number;
        const std::string where = argument.repeated ? "*" : fmt::format("{}", number);
        text +=
            " \\\n        " + in_shell_quotes(fmt::format("{}:{}", where, value_of(argument, argument.names.front())));
    }
    return text;
}

std::string leaf(const CommandEntry& command) {
    std::string text = fmt::format("{}() {{\n    _arguments -s -S", function_name(command));
    for (const OptionEntry& option : command.options) text += option_lines(option);
    return text + argument_lines(command) + "\n}\n";
}

/// A command with subcommands.
std::string branch(const CommandEntry& command) {
    std::string text = fmt::format("{}() {{\n    local -a below\n    below=(\n", function_name(command));
    for (const CommandEntry& below : command.below)
        text += "        " + in_shell_quotes(escaped(last_word(below.name)) + ":" + escaped(below.help)) + "\n";
    text += "    )\n    _arguments -C";
    for (const OptionEntry& option : command.options) text += option_lines(option);
    text += " \\\n        '1:command:->command' \\\n        '*::argument:->argument'\n";
    text += "    case $state in\n    command) _describe command below ;;\n    argument)\n        case $line[1] in\n";
    for (const CommandEntry& below : command.below)
        text += fmt::format("        {}) {} ;;\n", last_word(below.name), function_name(below));
    return text + "        esac ;;\n    esac\n}\n";
}

}  // namespace

std::string zsh_completion(const CommandEntry& program) {
    std::string text = "#compdef pliant\n# zsh completion for pliant, written by \"pliant completion zsh\"\n";
    for (const CommandEntry* command : all_commands(program))
        text += command->below.empty() ? leaf(*command) : branch(*command);
    text += branch(program);
    // Run as the function itself by the first Tab, or sourced by a profile that only defines it.
    return text +
           "if [ \"$funcstack[1]\" = _pliant ]; then\n    _pliant \"$@\"\nelse\n    compdef _pliant pliant\nfi\n";
}

}  // namespace pliant::app
