// pliant workspace: the positions that markers can reach.
#include "pliant/workspace.hpp"

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <memory>
#include <string>
#include <vector>

#include "command.hpp"
#include "inputs.hpp"
#include "output_option.hpp"
#include "watched.hpp"

namespace pliant::app {
namespace {

struct WorkspaceArguments {
    std::string robot;
    std::string folder;
    WorkspaceOptions search;
    std::vector<std::string> assignments;
    Output output;
};

/// Completed pieces are stored beside the results until these are written.
Result<WorkspaceOptions> search_options(const WorkspaceArguments& options) {
    WorkspaceOptions search = options.search;
    if (options.folder.empty() && search.resume)
        return input_error("--resume needs --output: the checkpoint is kept next to that folder");
    if (!options.folder.empty()) search.checkpoint = options.folder + ".checkpoint";
    return search;
}

int tell_cancelled(const WorkspaceArguments& options, const WorkspaceOptions& search) {
    fmt::print(stderr, "{}: cancelled{}\n", options.robot,
               search.checkpoint.empty()
                   ? ""
                   : fmt::format("; the same command with --resume continues from {}", search.checkpoint.string()));
    return exit_failed;
}

Result<int> workspace(const WorkspaceArguments& options) {
    if (Status status = expect(FileKind::robot, options.robot); !status) return tl::unexpected(status.error());
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
        if (!options.output.quiet || options.output.json) fmt::print("{}", found.json());
    } catch (const Failure& failure) {
        if (failure.kind() != Failure::Kind::cancelled) throw;
        progress.reset();
        return tell_cancelled(options, *search);
    }
    return exit_done;
}

}  // namespace

void add_workspace(CLI::App& app, int& status) {
    auto options = std::make_shared<WorkspaceArguments>();
    CLI::App* command =
        app.add_subcommand("workspace", "find where markers can get within the ranges of the actuators");
    command->add_option("robot", options->robot, "robot file (TOML) with ranges of actuators")->required();
    add_output_path(*command, options->folder, "folder for table, surfaces and picture");
    command
        ->add_option("--side", options->search.side, "samples along each input of a sheet, over which two inputs vary")
        ->check(CLI::Range(2, 1000))
        ->capture_default_str();
    command
        ->add_option("--between", options->search.between,
                     "samples spread over the ranges, besides those of the sheets")
        ->check(CLI::Range(0, 1000000))
        ->capture_default_str();
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
