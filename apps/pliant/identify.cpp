// pliant identify: finds parameters of a robot from measurements.
#include "pliant/identify.hpp"

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command.hpp"
#include "inputs.hpp"
#include "output_option.hpp"
#include "watched.hpp"

namespace pliant::app {
namespace {

struct IdentifyOptions {
    std::string robot;
    std::string measured;
    std::vector<std::string> unknowns;
    std::string judge_on;
    std::vector<std::string> assignments;
    std::string folder;  ///< empty: no output is written
    Output output;
};

Result<JudgeOn> read_judge(const std::string& text) {
    constexpr std::array<std::pair<std::string_view, JudgeOn>, 3> ways = {{
        {"", JudgeOn::nothing},
        {"every-second", JudgeOn::every_second},
        {"second-half", JudgeOn::second_half},
    }};
    const auto* const found = std::ranges::find(ways, text, [](const auto& way) { return way.first; });
    if (found != ways.end()) return found->second;
    return input_error("--judge-on: \"{}\" is neither every-second nor second-half", text);
}

Result<int> identify(const IdentifyOptions& options) {
    const Result<JudgeOn> judge = read_judge(options.judge_on);
    if (!judge) return tl::unexpected(judge.error());
    Status status = expect(FileKind::robot, options.robot);
    if (status)
        status = check_results_place(options.folder, "identified.toml", options.robot, options.assignments,
                                     options.measured);
    if (!status) return tl::unexpected(status.error());
    auto progress = terminal_progress(options.output);
    const Watch watch = watch_of(*progress);
    const Robot robot = Robot::load(options.robot, options.assignments);
    const Identification result =
        pliant::identify(robot, options.unknowns, Measurements::load(options.measured), *judge, {}, watch);
    if (!options.folder.empty()) result.write(options.folder);
    progress.reset();
    if (options.output.json)
        fmt::print("{}\n", result.json());
    else if (!options.output.quiet)
        fmt::print("{}", result.text());
    for (const std::string& warning : result.warnings())
        fmt::print(stderr, "{}: warning: {}\n", options.robot, warning);
    return result.converged() ? exit_done : exit_failed;
}

}  // namespace

void add_identify(CLI::App& app, int& status) {
    auto options = std::make_shared<IdentifyOptions>();
    CLI::App* command = app.add_subcommand("identify", "find parameters of a robot from measurements");
    command->add_option("robot", options->robot, "robot file")->required();
    command->add_option("--measured", options->measured, "CSV of measurements, each row at a time of the program")
        ->required();
    command
        ->add_option("--unknown", options->unknowns,
                     "key of a parameter to find, or KEY=LOW..HIGH with bounds; may be repeated")
        ->type_name("KEY")
        ->allow_extra_args(false)
        ->required();
    command->add_option("--judge-on", options->judge_on,
                        "rows to hold out of the fit and validate it with: every-second or second-half");
    command->add_option("--set", options->assignments, "KEY=VALUE: change any key of the robot file")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    add_output_path(*command, options->folder, "folder for identified.toml, summary.json, comparison.csv and plots");
    add_output_options(*command, options->output, true);
    command->footer(
        "Example: pliant identify finger.toml --measured video.csv --unknown material.soft.youngs_modulus -o found");
    on_call(*command, status, [options] { return identify(*options); });
}

}  // namespace pliant::app
