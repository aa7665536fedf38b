#include "usage.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/Error.hpp>
#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

#include "base/core/text.hpp"

namespace pliant::app {
namespace {

/// "pliant calibrate tensile".
std::string full_name(const CLI::App& command) {
    const CLI::App* const above = command.get_parent();
    return above == nullptr ? command.get_name() : full_name(*above) + " " + command.get_name();
}

/// "--speed = fast" as CLI11 shows it.
std::string not_converted(std::string_view shown) {
    const std::size_t sign = shown.find(" = ");
    if (sign == std::string_view::npos) return std::string(shown) + ": is not a number";
    return fmt::format("{}: write a number, not {}", shown.substr(0, sign), shown.substr(sign + 3));
}

std::string reason_of(const CLI::App& command, const CLI::ParseError& error) {
    const std::string_view text = error.what();
    constexpr std::string_view conversion = "Could not convert: ";
    if (text.starts_with(conversion)) return not_converted(text.substr(conversion.size()));
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !command.remaining().empty())
        return fmt::format("\"{}\" is one word too many", command.remaining().front());
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr && text.ends_with(" missing"))
        return std::string(text.substr(0, text.find(':'))) + " needs a value";
    return std::string(text);
}

/// The only name that begins with the word, or the nearest one; "": none is near.
std::string meant(const std::string& word, const std::vector<std::string>& names) {
    std::vector<std::string> longer;
    std::copy_if(names.begin(), names.end(), std::back_inserter(longer),
                 [&](const std::string& name) { return word.size() > 1 && name.starts_with(word); });
    return longer.size() == 1 ? longer.front() : nearest_name(word, names);
}

/// The option that is nearest to a word; "": none is. Dashes do not count, since all have them.
std::string nearest_option(const std::string& word, const std::vector<std::string>& names) {
    const std::size_t begin = std::min(word.find_first_not_of('-'), word.size());
    const std::string nearest = nearest_name(word.substr(begin), names);
    return nearest.empty() ? "" : "--" + nearest;
}

Error no_such(const CLI::App& command, std::string_view kind, const std::string& word, const std::string& nearest) {
    const std::string name = full_name(command);
    return {Cause::input, fmt::format("{}: there is no {} \"{}\"; {}", name, kind, word,
                                      nearest.empty() ? fmt::format("{} --help lists them", name)
                                                      : fmt::format("did you mean \"{}\"?", nearest))};
}

/// For a first word that is neither a command nor an option of the program.
Error no_such_command(const CLI::App& app, const std::string& word) {
    if (word.starts_with('-')) return no_such(app, "option", word, nearest_option(word, {"help", "version"}));
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    return no_such(app, "command", word, meant(word, names));
}

/// Words before a command, which only it understands, as in `pliant -o out simulate`.
std::optional<Error> out_of_order(const CLI::App& app) {
    for (const CLI::App* above = &app;;) {
        const auto below = above->get_subcommands();
        if (below.empty()) return std::nullopt;
        const std::vector<std::string> words = above->remaining();
        if (words.empty()) {
            above = below.front();
            continue;
        }
        if (!words.front().starts_with('-')) return no_such_command(*above, words.front());
        const std::string text = fmt::format("{}", fmt::join(words, " "));
        return Error{Cause::input, fmt::format("{}: \"{}\" stands before the command; options follow it: {} ... {}",
                                               full_name(*above), text, full_name(*below.front()), text)};
    }
}

}  // namespace

const CLI::App& given_command(const CLI::App& app) {
    const CLI::App* command = &app;
    for (auto below = app.get_subcommands(); !below.empty(); below = command->get_subcommands())
        command = below.front();
    return *command;
}

std::optional<Error> misspelt(const CLI::App& app) {
    const CLI::App& command = given_command(app);
    const std::vector<std::string> left = command.remaining();
    if (&command == &app) return left.empty() ? std::nullopt : std::optional(no_such_command(app, left.front()));
    if (std::optional<Error> order = out_of_order(app)) return order;
    const auto found = std::find_if(left.begin(), left.end(),
                                    [](const std::string& word) { return word.size() > 1 && word[0] == '-'; });
    if (found == left.end()) return std::nullopt;
    const std::string word = found->substr(0, found->find('='));
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back(name);
    }
    return no_such(command, "option", word, nearest_option(word, names));
}

Error usage_error(const CLI::App& command, const CLI::ParseError& error) {
    const std::string name = full_name(command), reason = reason_of(command, error);
    const bool is_value = dynamic_cast<const CLI::ValidationError*>(&error) != nullptr ||
                          dynamic_cast<const CLI::ConversionError*>(&error) != nullptr;  // says what would be right
    return {Cause::input, is_value ? fmt::format("{}: {}", name, reason)
                                   : fmt::format("{}: {}; {} --help lists what it takes", name, reason, name)};
}

}  // namespace pliant::app
