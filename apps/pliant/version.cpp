// pliant version: version of the program and the libraries it was built with.
#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command.hpp"
#include "printed.hpp"

namespace pliant::app {
namespace {

using Entry = std::pair<std::string, std::string>;

/// PLIANT_LIBRARIES is "Eigen=3.4.0|fmt=9.1.0|...", set by the build.
std::vector<Entry> libraries(std::string_view text) {
    std::vector<Entry> entries;
    while (!text.empty()) {
        const std::string_view entry = text.substr(0, text.find('|'));
        const std::size_t sign = entry.find('=');
        entries.emplace_back(entry.substr(0, sign), entry.substr(sign + 1));
        text.remove_prefix(std::min(entry.size() + 1, text.size()));
    }
    return entries;
}

void print_libraries(const std::vector<Entry>& used) {
    fmt::print("pliant {}\nbuilt with {}\nlibraries\n", PLIANT_VERSION, PLIANT_COMPILER);
    for (const auto& [name, version] : used) fmt::print("  {:<14} {}\n", name, version);
}

Status tell_version(const Output& output) {
    const std::vector<Entry> used = libraries(PLIANT_LIBRARIES);
    if (output.json) {
        nlohmann::ordered_json json = {{"pliant", PLIANT_VERSION}, {"compiler", PLIANT_COMPILER}};
        for (const auto& [name, version] : used) json["libraries"][name] = version;
        print_json(json);
    } else if (output.quiet) {
        fmt::print("{}\n", PLIANT_VERSION);
    } else {
        print_libraries(used);
    }
    return {};
}

}  // namespace

void add_version(CLI::App& app, int& status) {
    auto output = std::make_shared<Output>();
    CLI::App* command = app.add_subcommand("version", "print the version, and those of the libraries");
    command->add_flag("-q,--quiet", output->quiet, "print the version only");
    command->add_flag("--json", output->json, "print the result as JSON");
    command->footer("Example: pliant version --json");
    on_call(*command, status, [output] { return tell_version(*output); });
}

}  // namespace pliant::app
