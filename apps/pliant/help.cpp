// pliant help: prints the --help of a command, for users who expect `help COMMAND`.
#include <fmt/core.h>

#include <CLI/Formatter.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/core/text.hpp"
#include "command.hpp"
#include "printed.hpp"

namespace pliant::app {
namespace {

/// The command of that name directly below `app`; the error suggests the closest name.
Result<const CLI::App*> command_below(const CLI::App& app, const std::string& path, const std::string& name) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        if (command->get_name() == name) return command;
        names.push_back(command->get_name());
    }
    const std::string nearest = nearest_name(name, names);
    return input_error("pliant help: there is no command \"{}{}\"; {}", path, name,
                       nearest.empty() ? "pliant --help lists them" : "did you mean \"" + path + nearest + "\"?");
}

/// What the help says, for programs: name, text, options and commands.
nlohmann::ordered_json help_json(const CLI::App& command, const std::string& name) {
    nlohmann::ordered_json json = {{"command", name}, {"text", command.get_description()}};
    json["options"] = json["commands"] = nlohmann::ordered_json::array();
    for (const CLI::Option* option : command.get_options()) {
        json["options"].push_back({{"name", option->get_name(option->get_positional())},
                                   {"text", option->get_description()},
                                   {"required", option->get_required()},
                                   {"takes_a_value", option->get_items_expected_max() > 0}});
    }
    for (const CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; })) {
        if (!below->get_group().empty())
            json["commands"].push_back({{"name", below->get_name()}, {"text", below->get_description()}});
    }
    return json;
}

Status help(const CLI::App& app, const std::vector<std::string>& words, bool as_json) {
    const CLI::App* command = &app;
    std::string path, full = app.get_name();
    for (const std::string& word : words) {
        const Result<const CLI::App*> below = command_below(*command, path, word);
        if (!below) return tl::unexpected(below.error());
        command = *below;
        path += word + " ";
        full += " " + word;
    }
    if (as_json) {
        print_json(help_json(*command, full));
        return {};
    }
    // Not command->help(), which prints the help of the running command.
    fmt::print("{}", command->get_formatter()->make_help(command, full, CLI::AppFormatMode::Normal));
    return {};
}

}  // namespace

void add_help(CLI::App& app, int& status) {
    auto words = std::make_shared<std::vector<std::string>>();
    CLI::App* command = app.add_subcommand("help", "print the help of a command");
    command->add_option("command", *words, "the command, as in: pliant help calibrate tensile");
    auto json = std::make_shared<bool>(false);
    command->add_flag("--json", *json, "print the result as JSON");
    command->footer("Example: pliant help slice");
    on_call(*command, status, [words, json, &app] { return help(app, *words, *json); });
}

}  // namespace pliant::app
