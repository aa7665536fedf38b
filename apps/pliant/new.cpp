// pliant new: creates a robot or printer file from a built-in one.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/config.hpp"
#include "base/core/files.hpp"
#include "base/core/letters.hpp"
#include "base/core/shell_word.hpp"
#include "base/core/text.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "printed.hpp"
#include "printing/machine/built_in_printers.hpp"
#include "studio/built_in/examples.hpp"

namespace pliant::app {
namespace {

namespace fs = std::filesystem;

struct NewOptions {
    std::string robot, printer, file;
    std::optional<std::string> name;
    Output output;
};

/// The value of the line `name = "..."` at the beginning of a file, if there is one.
std::string_view title_of(std::string_view text) {
    constexpr std::string_view key = "name = \"";
    const std::size_t at = text.starts_with(key) ? 0 : text.find("\n" + std::string(key));
    if (at == std::string_view::npos) return "";
    const std::size_t begin = at + key.size() + (at == 0 ? 0 : 1);
    return text.substr(begin, text.find('"', begin) - begin);
}

/// The same text with another name. Precondition: it has a name.
std::string renamed(std::string_view text, std::string_view name) {
    const std::string_view title = title_of(text);
    const auto at = static_cast<std::size_t>(title.data() - text.data());
    return std::string(text.substr(0, at)) + std::string(name) + std::string(text.substr(at + title.size()));
}

nlohmann::json list_json(std::span<const EmbeddedFile> files) {
    nlohmann::json list = nlohmann::json::array();
    for (const EmbeddedFile& file : files) list.push_back({{"template", file.name}, {"name", title_of(file.text)}});
    return list;
}

void print_list(const char* heading, std::span<const EmbeddedFile> files) {
    fmt::print("{}\n", heading);
    for (const EmbeddedFile& file : files) fmt::print("  {:<18} {}\n", file.name, title_of(file.text));
}

Status list_built_in(const NewOptions& options) {
    if (options.output.json) {
        print_json(nlohmann::json{{"robots", list_json(studio::example_robots())},
                                  {"printers", list_json(machine::built_in_printers())}});
        return {};
    }
    print_list("robots: pliant new TEMPLATE -o FILE.toml", studio::example_robots());
    print_list("printers: pliant new --printer TEMPLATE -o FILE.toml", machine::built_in_printers());
    return {};
}

tl::unexpected<Error> no_such_template(const std::string& name, std::span<const EmbeddedFile> files) {
    std::vector<std::string> names;
    for (const EmbeddedFile& file : files) names.emplace_back(file.name);
    const std::string nearest = nearest_name(name, names);
    if (nearest.empty()) return input_error("{}: there is no such template; there are {}", name, join_names(names));
    return input_error("{}: there is no such template; did you mean \"{}\"?", name, nearest);
}

Status check_name(const std::optional<std::string>& wanted) {
    const std::string name = wanted.value_or("-");
    if (trimmed(name).empty()) return input_error("--name: the name is empty");
    if (name.find_first_of("\"\\") != std::string::npos || std::ranges::any_of(name, is_control))
        return input_error("--name {}: must have no quotes, backslashes, line breaks or control characters",
                           one_line(name));
    if (!config::parse("name = \"" + name + "\"", "--name")) return input_error("--name: is not UTF-8 text");
    return {};
}

Status make(const NewOptions& options) {
    if (!options.robot.empty() && !options.printer.empty())
        return input_error("give the template of a robot, or --printer with that of a printer");
    const bool of_robots = options.printer.empty();
    const std::string& name = of_robots ? options.robot : options.printer;
    const auto files = of_robots ? studio::example_robots() : machine::built_in_printers();
    const EmbeddedFile* found = find_file(files, name);
    if (found == nullptr) return no_such_template(name, files);
    const std::string file = options.file.empty() ? name + ".toml" : options.file;
    Status fits = check_ending("-o", file, of_robots ? "a robot file" : "a printer file", ".toml");
    if (fits) fits = check_name(options.name);
    if (!fits) return fits;
    std::error_code ignored;
    if (fs::exists(file, ignored)) return input_error("{}: exists and is not overwritten; choose another name", file);
    const std::string text = options.name ? renamed(found->text, *options.name) : std::string(found->text);
    if (fs::path(file).has_parent_path()) fs::create_directories(fs::path(file).parent_path(), ignored);
    if (Status written = write_file(file, text); !written) return written;
    const std::string word = shell_word(file);
    const std::string next = of_robots ? fmt::format("pliant studio {0}   or   pliant simulate {0} -o out", word)
                                       : fmt::format("pliant slice ROBOT.toml --printer {} -o JOB.zip", word);
    if (options.output.json)
        print_json(nlohmann::json{{"file", file}, {"template", name}, {"name", title_of(text)}});
    else if (!options.output.quiet)
        fmt::print("{}: {}\nnext: {}\n", file, title_of(text), next);
    return {};
}

}  // namespace

void add_new(CLI::App& app, int& status) {
    auto options = std::make_shared<NewOptions>();
    CLI::App* command = app.add_subcommand("new", "write a robot file or a printer file from a template");
    command->add_option("template", options->robot, "template of a robot; without it all templates are listed");
    command->add_option("--printer", options->printer, "write a printer file instead, from this template");
    command->add_option("-o,--output", options->file, "file to write (.toml); TEMPLATE.toml if not given");
    command->add_option("--name", options->name, "name of the robot, or of the printer, in the file");
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant new cable_gripper --name \"my gripper\" -o my_gripper.toml");
    on_call(*command, status, [options] {
        return options->robot.empty() && options->printer.empty() ? list_built_in(*options) : make(*options);
    });
}

}  // namespace pliant::app
