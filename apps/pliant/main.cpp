// The command line: one file per command, each a thin layer over the library.
#include <fmt/format.h>
#include <malloc.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "../standard_streams.hpp"
#include "../usage.hpp"
#include "command.hpp"
#include "interrupt.hpp"
#include "printed.hpp"
#include "program.hpp"
#include "study_rows.hpp"

namespace {

struct Command {
    std::string_view name;
    pliant::app::AddCommand add;
    bool needs_all = false;  ///< it reads what the other commands are
};

/// In the order of the help.
constexpr std::array<Command, 23> commands = [] {
    using namespace pliant::app;
    return std::to_array<Command>({{"new", add_new},
                                   {"simulate", add_simulate},
                                   {"inverse", add_inverse},
                                   {"workspace", add_workspace},
                                   {"reduce", add_reduce},
                                   {"mesh", add_mesh},
                                   {"slice", add_slice},
                                   {"plan", add_plan},
                                   {"export", add_export},
                                   {"print", add_print},
                                   {"twin", add_twin},
                                   {"firmware", add_firmware},
                                   {"project", add_project},
                                   {"compare-printers", add_compare_printers},
                                   {"check", add_check},
                                   {"materials", add_materials},
                                   {"calibrate", add_calibrate},
                                   {"identify", add_identify},
                                   {"study", add_study},
                                   {"studio", add_studio},
                                   {"help", add_help, true},
                                   {"version", add_version},
                                   {"completion", add_completion, true}});
}();

/// The commands that have to be known for a command line: one that begins with a command needs no other. Registering
/// all of them, with their options, takes longer than the rest of a short run.
std::vector<Command> needed(const std::vector<std::string>& words) {
    const std::string first = words.empty() ? "" : words.front();
    if (first == "--version") return {};
    const auto given =
        std::find_if(commands.begin(), commands.end(), [&](const Command& command) { return command.name == first; });
    if (given == commands.end() || given->needs_all) return {commands.begin(), commands.end()};
    return {*given};
}

void add_commands(CLI::App& app, const std::vector<Command>& known, int& status) {
    app.set_version_flag("--version", std::string(PLIANT_VERSION));
    app.require_subcommand(1);
    app.footer(
        "Example: pliant simulate examples/cable_gripper/gripper.toml -o out\nEvery command has its own --help.");
    for (const Command& command : known) command.add(app, status);
}

int refuse_output(const std::string& reason) {
    fmt::print(stderr, "standard output: cannot be written: {}\n", reason);
    return pliant::app::exit_failed;
}

/// A status of success only if all that was printed has been written.
int flushed(int status) {
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
    return refuse_output(errno != 0 ? std::strerror(errno) : "unknown error");
}

constexpr const char* about = "Pliant simulates multi-material soft robots and prints them on multi-vat DLP printers.";

}  // namespace

int pliant::app::run_program(const std::vector<std::string>& words) {
    CLI::App app(about, "pliant");
    int status = exit_done;
    add_commands(app, needed(words), status);
    try {
        app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    } catch (const CLI::ParseError& error) {
        // Help is for a command that there is.
        const bool asks = error.get_exit_code() == 0 && !app.get_subcommands().empty();
        if (const auto slip = misspelt(app); slip && !asks) {
            fmt::print(stderr, "{}\n", one_line(slip->message));
            return exit_bad_input;
        }
        if (words.empty()) {  // the help says more than that a command is missing
            fmt::print(stderr, "{}", app.help());
            return exit_bad_input;
        }
        if (error.get_exit_code() == 0) return app.exit(error);  // it asks for the help or the version
        return report(usage_error(given_command(app), error),
                      std::find(words.begin(), words.end(), "--json") != words.end());
    }
    return status;
}

std::vector<std::string> pliant::app::commands_of_studies() {
    constexpr std::array<std::string_view, 5> others{"study", "studio", "print", "twin", "project"};
    CLI::App app(about, "pliant");
    int status = exit_done;
    add_commands(app, {commands.begin(), commands.end()}, status);
    std::vector<std::string> names;
    const auto all = [](const CLI::App*) { return true; };
    for (const CLI::App* command : app.get_subcommands(all)) {
        const bool json = command->get_option_no_throw("--json") != nullptr || !command->get_subcommands(all).empty();
        if (json && std::find(others.begin(), others.end(), command->get_name()) == others.end())
            names.push_back(command->get_name());
    }
    return names;
}

// Only std::bad_alloc can escape, which ends the program in any case.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    // The solver repeatedly allocates and frees the same large blocks: keep them instead of mapping them anew.
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    pliant::app::secure_standard_streams();
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (!words.empty() && words.front() == pliant::app::study_rows_word) return pliant::app::serve_study_rows(words);
    if (std::find(words.begin(), words.end(), "--json") != words.end()) pliant::app::tell_cancelled_in_json();
    try {
        return flushed(pliant::app::run_program(words));
    } catch (const std::system_error& error) {  // of fmt::print, when standard output cannot be written
        return refuse_output(error.code().message());
    }
}
