// Common to all commands: exit status, error reports and progress.
#pragma once

#include <CLI/App.hpp>
#include <initializer_list>
#include <memory>
#include <string>
#include <type_traits>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "pliant/base.hpp"

namespace pliant::app {

/// Exit status of every command, as docs/reference/commands.md tells users.
enum Exit { exit_done = 0, exit_failed = 1, exit_bad_input = 2 };

/// `-q`, `-v` and `--json`, as given on the command line.
struct Output {
    bool quiet = false;
    bool json = false;
};

/// A command adds itself to the parser; `status` receives its exit status when it has run.
using AddCommand = void (*)(CLI::App& app, int& status);
void add_new(CLI::App& app, int& status);
void add_study(CLI::App& app, int& status);
void add_simulate(CLI::App& app, int& status);
void add_inverse(CLI::App& app, int& status);
void add_workspace(CLI::App& app, int& status);
void add_reduce(CLI::App& app, int& status);
void add_mesh(CLI::App& app, int& status);
void add_slice(CLI::App& app, int& status);
void add_plan(CLI::App& app, int& status);
void add_export(CLI::App& app, int& status);
void add_print(CLI::App& app, int& status);
void add_twin(CLI::App& app, int& status);
void add_compare_printers(CLI::App& app, int& status);
void add_firmware(CLI::App& app, int& status);
void add_project(CLI::App& app, int& status);
void add_check(CLI::App& app, int& status);
void add_materials(CLI::App& app, int& status);
void add_calibrate(CLI::App& app, int& status);
void add_identify(CLI::App& app, int& status);
void add_studio(CLI::App& app, int& status);
void add_help(CLI::App& app, int& status);
void add_version(CLI::App& app, int& status);
void add_completion(CLI::App& app, int& status);

void add_output_options(CLI::App& command, Output& output, bool with_json);

/// Prints the error to stderr and returns its exit status; with --json also prints `{"error": "..."}` to stdout, so
/// that a program that reads it always gets JSON.
int report(const Error& error, bool json = false);
int report(const Failure& failure, bool json = false);

/// True if --json was given to this command.
[[nodiscard]] bool asks_for_json(const CLI::App& command);

/// Registers the action of `command`: `work` returns a Status, or a Result with the exit status.
template <class Work>
void on_call(CLI::App& command, int& status, Work work) {
    command.callback([work, &status, &command] {
        try {
            const auto result = work();
            if (!result)
                status = report(result.error(), asks_for_json(command));
            else if constexpr (std::is_same_v<decltype(result), const Result<int>>)
                status = *result;
            else
                status = exit_done;
        } catch (const Failure& failure) {
            status = report(failure, asks_for_json(command));
        }
    });
}

/// An error, before any work, for a file that cannot be written (check_file_place). Empty names stand for none.
[[nodiscard]] Status check_file_places(std::initializer_list<std::string> files);

/// A progress bar on stderr, if it is a terminal, for work that takes over a second; Ctrl-C and SIGTERM cancel
/// (interrupt.hpp).
[[nodiscard]] std::unique_ptr<Progress> terminal_progress(const Output& output);

}  // namespace pliant::app
