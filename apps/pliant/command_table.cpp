#include "command_table.hpp"

#include <nlohmann/json.hpp>
#include <string_view>

#include "base/core/json.hpp"
#include "printing/machine/built_in_printers.hpp"
#include "robot/file/material_library.hpp"

namespace pliant::app {
namespace {

using Json = nlohmann::json;

std::vector<std::string> split(std::string_view text, char by) {
    std::vector<std::string> words;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(by), text.size());
        words.emplace_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return words;
}

/// Names of built-in things that are accepted in place of a file.
std::vector<std::string> built_in(const std::string& name) {
    std::vector<std::string> words;
    if (name == "--printer" || name == "printer" || name == "printers") {
        for (const EmbeddedFile& file : machine::built_in_printers()) words.emplace_back(file.name);
    } else if (name == "names") {
        for (const EmbeddedFile& file : robot::library_files()) words.emplace_back(file.name);
    }
    return words;
}

/// CLI11 appends the check to the type: "TEXT:{yeoh,ogden}", "INT:INT in [1 - 3]".
void read_type(const std::string& type, OptionEntry& entry) {
    entry.value = type;
    if (const std::size_t open = type.find(":{"); open != std::string::npos) {
        entry.choices = split(std::string_view(type).substr(open + 2, type.size() - open - 3), ',');
        entry.open = false;
        entry.value.resize(open);
    } else if (const std::size_t in = type.find(" in ["); in != std::string::npos) {
        entry.range = type.substr(in + 5, type.size() - in - 6);
        entry.value.resize(type.find(':'));
    }
}

OptionEntry option_entry(const CLI::Option& option) {
    OptionEntry entry;
    for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
    if (entry.names.empty()) entry.names.push_back(option.get_name(true));
    entry.help = option.get_description();
    entry.required = option.get_required();
    if (option.get_items_expected_min() == 0) return entry;  // a flag
    entry.repeated = option.get_expected_max() >= CLI::detail::expected_max_vector_size;
    entry.values = option.get_type_size() * (entry.repeated ? 1 : std::max(option.get_expected_max(), 1));
    read_type(option.get_type_name(), entry);
    entry.usual = option.get_default_str();
    if (entry.choices.empty()) entry.choices = built_in(entry.names.back());
    return entry;
}

CommandEntry entry_of(const CLI::App& command, const std::string& name) {
    CommandEntry entry{name, command.get_description(), command.get_footer(), {}, {}, {}};
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_group().empty()) continue;
        (option->nonpositional() ? entry.options : entry.arguments).push_back(option_entry(*option));
    }
    for (const CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; })) {
        if (below->get_group().empty()) continue;
        entry.below.push_back(entry_of(*below, name.empty() ? below->get_name() : name + " " + below->get_name()));
    }
    return entry;
}

Json table_entry(const OptionEntry& entry) {
    return {{"names", entry.names},  {"value", entry.value},       {"range", entry.range},
            {"usual", entry.usual},  {"help", entry.help},         {"choices", entry.choices},
            {"open", entry.open},    {"required", entry.required}, {"repeated", entry.repeated},
            {"values", entry.values}};
}

Json table_entry(const CommandEntry& entry) {
    Json json = {{"name", entry.name},         {"help", entry.help},       {"footer", entry.footer},
                 {"arguments", Json::array()}, {"options", Json::array()}, {"below", Json::array()}};
    for (const OptionEntry& argument : entry.arguments) json["arguments"].push_back(table_entry(argument));
    for (const OptionEntry& option : entry.options) json["options"].push_back(table_entry(option));
    for (const CommandEntry& below : entry.below) json["below"].push_back(table_entry(below));
    return json;
}

}  // namespace

CommandEntry command_table(const CLI::App& program) {
    CommandEntry table = entry_of(program, "");
    std::vector<std::string> names;
    for (const CommandEntry& entry : table.below) names.push_back(entry.name);
    for (CommandEntry& entry : table.below) {
        if (entry.name != "help") continue;
        entry.arguments.front().choices = names;
        entry.arguments.front().open = false;
    }
    return table;
}

std::string table_json(const CommandEntry& table) {
    return json_text(table_entry(table), 1);
}

}  // namespace pliant::app
