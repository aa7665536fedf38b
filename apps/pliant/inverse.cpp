// pliant inverse: finds the inputs of the actuators with which the robot meets its goals.
#include "pliant/inverse.hpp"

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "../usage.hpp"
#include "base/core/counted.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "output_option.hpp"
#include "presentation/report/results.hpp"
#include "watched.hpp"

namespace pliant::app {
namespace {

struct InverseArguments {
    std::string robot;
    std::string folder;
    InverseOptions search;
    std::vector<std::string> assignments;
    Output output;
};

struct FoundProgram {
    std::vector<std::string> warnings{};  ///< of the folder, if it was written
    bool written = false, all_drawn = true;
};

void print_found(const InverseArguments& options, const Model& model, const InverseResult& result, bool written) {
    fmt::print("{}, {}\n{}", counted(model.node_count(), "node"),
               counted(model.tet_count(), model.order() == 2 ? "quadratic tet" : "linear tet"), result.text());
    if (written) fmt::print("results: {}, open report.html there\n", options.folder);
}

/// While files are written, the first signal, or an earlier one, skips the pictures; only the second cancels.
FoundProgram write_found(const InverseArguments& options, const InverseResult& result, Progress& progress) {
    FoundProgram found;
    found.written = !options.folder.empty() && result.waypoint_count() > 0;
    if (!found.written) return found;
    on_signal(OnSignal::ask_twice);
    const auto watch = [&](std::string_view stage, double share) {
        progress.advance(stage, share);
        return !interrupted_again();
    };
    const auto enough_pictures = [&] {
        found.all_drawn = !interrupted();
        return !found.all_drawn;
    };
    found.warnings = result.write(options.folder, watch, enough_pictures);
    return found;
}

/// Prints the results, and returns the exit status.
int tell_found(const InverseArguments& options, const Model& model, const InverseResult& result,
               const FoundProgram& found) {
    if (options.output.json)
        fmt::print("{}", result.json(found.warnings));
    else if (!options.output.quiet)
        print_found(options, model, result, found.written);
    const auto warn = [&](const std::string& text) { fmt::print(stderr, "{}: warning: {}\n", options.robot, text); };
    std::ranges::for_each(result.notes(), warn);
    std::ranges::for_each(found.warnings, warn);
    if (!result.message().empty())
        fmt::print(stderr, "{}: {}\n", options.robot, result.message());
    else if (!found.all_drawn)
        fmt::print(stderr, "{}: cancelled before all pictures were drawn; the other results are written\n",
                   options.robot);
    return result.reached() && found.all_drawn ? exit_done : exit_failed;
}

Result<int> inverse(const InverseArguments& options) {
    Status status = expect(FileKind::robot, options.robot);
    if (status)
        status = check_results_place(options.folder, report::inverse_mark(), options.robot, options.assignments);
    if (!status) return tl::unexpected(status.error());
    auto progress = terminal_progress(options.output);
    const Watch watch = watch_of(*progress);
    const Model model = load_model(options.robot, options.assignments, watch);
    InverseOptions search = options.search;
    search.to_write = !options.folder.empty();
    const InverseResult result = pliant::inverse(model, search, watch);
    const FoundProgram found = write_found(options, result, *progress);
    progress.reset();
    return tell_found(options, model, result, found);
}

}  // namespace

void add_inverse(CLI::App& app, int& status) {
    auto options = std::make_shared<InverseArguments>();
    CLI::App* command =
        app.add_subcommand("inverse", "find the inputs of the actuators with which the robot meets its goals");
    command->add_option("robot", options->robot, "robot file (TOML) with [[goal]], and ranges of actuators")
        ->required();
    add_output_path(*command, options->folder,
                    "folder for the resulting program and its results; without it only a summary is printed");
    command
        ->add_option("--starts", options->search.starts,
                     "starts spread over the ranges, tried where the path from rest does not reach the first waypoint")
        ->check(between(0, 1000))
        ->capture_default_str();
    command->add_option("--set", options->assignments, "KEY=VALUE: change any key, as in goal.reach.tolerance=\"1 mm\"")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant inverse examples/inverse/trunk_helix/robot.toml -o out");
    on_call(*command, status, [options] { return inverse(*options); });
}

}  // namespace pliant::app
