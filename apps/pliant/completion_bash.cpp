#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/core/process.hpp"
#include "completion.hpp"

namespace pliant::app {
namespace {

/// The word before the cursor word; bash splits `--law=yeoh` into three words.
constexpr const char* bash_head = R"(# bash completion for pliant, written by "pliant completion bash"
_pliant() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command='' i
    if [[ $word == = ]]; then
        word=''
    elif [[ $before == = ]]; then
        before=${COMP_WORDS[COMP_CWORD - 2]}
    fi
    for ((i = 1; i < COMP_CWORD; i++)); do
        case "$command/${COMP_WORDS[i]}" in
)";

constexpr const char* tail = R"(    esac
    COMPREPLY=()
    case $word in
    -*) words=$options ;;
    esac
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
    if [[ $files && $word != -* ]]; then
        compopt -o filenames 2>/dev/null
        local -a found
        mapfile -t found < <(compgen -f -- "$word")
        COMPREPLY+=("${found[@]}")
    fi
}
complete -F _pliant pliant
)";

std::string words_and_files(const OptionEntry& entry) {
    return fmt::format("words={} files={}", in_shell_quotes(fmt::format("{}", fmt::join(entry.choices, " "))),
                       takes_files(entry) ? "yes" : "");
}

/// The last word of "calibrate tensile", and the words before it.
std::pair<std::string, std::string> parted(const std::string& name) {
    const std::size_t space = name.rfind(' ');
    if (space == std::string::npos) return {"", name};
    return {name.substr(0, space), name.substr(space + 1)};
}

std::string option_names(const CommandEntry& entry) {
    std::vector<std::string> names;
    for (const OptionEntry& option : entry.options) names.insert(names.end(), option.names.begin(), option.names.end());
    return fmt::format("{}", fmt::join(names, " "));
}

std::string names_below(const CommandEntry& entry) {
    std::vector<std::string> names;
    for (const CommandEntry& below : entry.below) names.push_back(parted(below.name).second);
    return fmt::format("{}", fmt::join(names, " "));
}

/// Completions for a command's positional arguments: its subcommands, or words and files of the first argument.
std::string arguments_of(const CommandEntry& entry) {
    if (!entry.below.empty()) return fmt::format("words={} files=", in_shell_quotes(names_below(entry)));
    return entry.arguments.empty() ? "words='' files=" : words_and_files(entry.arguments.front());
}

}  // namespace

std::string bash_completion(const CommandEntry& program) {
    std::string text = bash_head;
    for (const CommandEntry* command : all_commands(program)) {
        const auto [above, last] = parted(command->name);
        text += fmt::format("        {}) command={} ;;\n", in_shell_quotes(above + "/" + last),
                            in_shell_quotes(command->name));
    }
    text += "        esac\n    done\n    local words files options\n    case $command in\n";
    text += fmt::format("    '') words={} options={} ;;\n", in_shell_quotes(names_below(program)),
                        in_shell_quotes(option_names(program)));
    for (const CommandEntry* command : all_commands(program))
        text += fmt::format("    {}) {} options={} ;;\n", in_shell_quotes(command->name), arguments_of(*command),
                            in_shell_quotes(option_names(*command)));
    text += "    esac\n    case \"$command $before\" in\n";
    for (const CommandEntry* command : all_commands(program)) {
        for (const OptionEntry& option : command->options) {
            if (option.values == 0) continue;
            std::vector<std::string> patterns;
            for (const std::string& name : option.names)
                patterns.push_back(in_shell_quotes(command->name + " " + name));
            text += fmt::format("    {}) {} options='' ;;\n", fmt::join(patterns, " | "), words_and_files(option));
        }
    }
    return text + tail;
}

}  // namespace pliant::app
