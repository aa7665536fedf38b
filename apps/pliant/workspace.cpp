// pliant workspace: the positions that markers can reach.
#include "pliant/workspace.hpp"

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "../usage.hpp"
#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "output_option.hpp"
#include "printed.hpp"
#include "simulation/inverse/workspace.hpp"
#include "watched.hpp"

namespace pliant::app {
namespace {

struct WorkspaceArguments {
    std::string robot;
    std::string folder;
    WorkspaceOptions search;
    std::optional<int> side, between;
    std::vector<std::string> assignments;
    Output output;
};

/// Completed pieces are stored beside the results until these are written.
Result<WorkspaceOptions> search_options(const WorkspaceArguments& options) {
    WorkspaceOptions search = options.search;
    search.side = options.side.value_or(search.side);
    search.between = options.between.value_or(search.between);
    if (options.folder.empty() && search.resume)
        return input_error("--resume needs --output: the checkpoint is kept next to that folder");
    if (!options.folder.empty()) search.checkpoint = beside_folder(options.folder, ".checkpoint");
    return search;
}

int tell_cancelled(const WorkspaceArguments& options, const WorkspaceOptions& search) {
    fmt::print(stderr, "{}: cancelled{}\n", options.robot,
               search.checkpoint.empty()
                   ? ""
                   : fmt::format("; the same command with --resume continues from {}", search.checkpoint.string()));
    if (options.output.json) print_json(nlohmann::json{{"error", "cancelled"}}, -1);
    return exit_failed;
}

/// The box that a marker has reached, in mm.
struct Reach {
    std::array<double, 3> low, high;
};

Reach reach_of(const std::vector<Point>& points) {
    constexpr double far = std::numeric_limits<double>::infinity();
    Reach reach{{far, far, far}, {-far, -far, -far}};
    for (const Point& p : points) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            reach.low[axis] = std::min(reach.low[axis], 1e3 * p[axis]);
            reach.high[axis] = std::max(reach.high[axis], 1e3 * p[axis]);
        }
    }
    return reach;
}

void print_workspace(const WorkspaceArguments& options, const Model& model, const Workspace& found) {
    const std::vector<std::string> markers = model.markers();
    std::vector<std::vector<Point>> positions(markers.size());
    std::size_t solved = 0;
    for (std::size_t k = 0; k < found.sample_count(); ++k) {
        const WorkspaceSample sample = found.sample(k);
        solved += sample.found ? 1 : 0;
        for (std::size_t m = 0; m < sample.markers.size(); ++m) positions[m].push_back(sample.markers[m]);
    }
    fmt::print("{}, {}\n{} of {} solved, over the ranges of {}\n", counted(model.node_count(), "node"),
               counted(model.tet_count(), model.order() == 2 ? "quadratic tet" : "linear tet"), solved,
               counted(found.sample_count(), "sample"), counted(found.inputs().size(), "actuator"));
    for (std::size_t m = 0; solved > 0 && m < markers.size(); ++m) {
        const auto [low, high] = reach_of(positions[m]);
        fmt::print("marker {}: x from {:.3f} to {:.3f}, y from {:.3f} to {:.3f}, z from {:.3f} to {:.3f} mm\n",
                   markers[m], low[0], high[0], low[1], high[1], low[2], high[2]);
    }
    if (!options.folder.empty()) fmt::print("results: {}\n", options.folder);
}

/// An option that this search has no use for.
void note_useless_options(const WorkspaceArguments& options, std::size_t inputs) {
    if (options.between && inputs == 1)
        fmt::print(stderr, "{}: note: --between is for two actuators or more; --side gives the samples of one\n",
                   options.robot);
    if (options.side && inputs > sim::inverse::most_inputs_with_sheets)
        fmt::print(stderr, "{}: note: --side is for up to {} actuators; --between gives the samples of more\n",
                   options.robot, sim::inverse::most_inputs_with_sheets);
}

Result<int> workspace(const WorkspaceArguments& options) {
    if (Status status = expect(FileKind::robot, options.robot); !status) return tl::unexpected(status.error());
    if (Status place = check_results_place(options.folder, "workspace.json", options.robot, options.assignments);
        !place)
        return tl::unexpected(place.error());
    const Result<WorkspaceOptions> search = search_options(options);
    if (!search) return tl::unexpected(search.error());
    auto progress = terminal_progress(options.output);
    const Watch watch = watch_of(*progress);
    const Model model = load_model(options.robot, options.assignments, watch);
    try {
        const Workspace found = pliant::workspace(model, *search, watch);
        if (!options.folder.empty()) {
            found.write(options.folder, watch);
            found.remove_checkpoint();
        }
        progress.reset();
        if (options.output.json)
            fmt::print("{}", found.json());
        else if (!options.output.quiet)
            print_workspace(options, model, found);
        for (const std::string& warning : found.warnings())
            fmt::print(stderr, "{}: warning: {}\n", options.robot, warning);
        note_useless_options(options, found.inputs().size());
        if (found.message().empty()) return exit_done;
        fmt::print(stderr, "{}: {}\n", options.robot, found.message());
        return exit_failed;
    } catch (const Failure& failure) {
        if (failure.kind() != Failure::Kind::cancelled) throw;
        progress.reset();
        return tell_cancelled(options, *search);
    }
}

}  // namespace

void add_workspace(CLI::App& app, int& status) {
    auto options = std::make_shared<WorkspaceArguments>();
    CLI::App* command =
        app.add_subcommand("workspace", "find where markers can get within the ranges of the actuators");
    command->add_option("robot", options->robot, "robot file (TOML) with ranges of actuators")->required();
    add_output_path(*command, options->folder, "folder for table, surfaces and picture");
    command
        ->add_option("--side", options->side,
                     "samples along each input of a sheet, over which two inputs vary, or of the only one (default 9)")
        ->check(between(2, 1000));
    command
        ->add_option("--between", options->between,
                     "samples spread over the ranges of two actuators or more, besides those of the sheets (default "
                     "100)")
        ->check(between(0, 1000000));
    command->add_flag("--resume", options->search.resume,
                      "resume from FOLDER.checkpoint; the results are the same as without a stop");
    command->add_option("--set", options->assignments, "KEY=VALUE: change any key, as in cable.flexor.range=[0.8, 1]")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant workspace examples/inverse/trunk_helix/robot.toml -o out");
    on_call(*command, status, [options] { return workspace(*options); });
}

}  // namespace pliant::app
