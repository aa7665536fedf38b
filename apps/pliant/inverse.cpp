// pliant inverse: what to pull so that the robot meets its goals.
#include <fmt/core.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "base/core/stopwatch.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "presentation/report/inverse_tables.hpp"
#include "presentation/report/results.hpp"
#include "presentation/report/summary.hpp"
#include "robot/file/program_writer.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/inverse/follow.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/scene/build_goals.hpp"
#include "simulation/scene/scene.hpp"

namespace pliant::app {
namespace {

struct Options {
    std::string robot;
    std::string folder;
    int starts = sim::inverse::FollowOptions{}.starts;
    std::vector<std::string> assignments;
    Output output;
};

/// Equilibria that are compared with a goal have to be nearer to it than its tolerance is wide.
constexpr double tightest_needed = 1e-5;

struct Solved {
    robot::Scene scene;
    sim::InverseTask task;
    sim::inverse::InverseResult result;
    [[nodiscard]] report::InverseReport report() const { return {scene.robot.name, scene.model, task, result}; }
};

double tolerance_of(const robot::Robot& robot) {
    return std::min(robot.program.tolerance, tightest_needed);
}

Result<Solved> solve(const Options& options, Progress& progress) {
    Result<robot::Robot> robot = read_robot(options.robot, options.assignments);
    if (!robot) return tl::unexpected(robot.error());
    Result<robot::Scene> scene = robot::build_scene(std::move(*robot), progress);
    if (!scene) return tl::unexpected(scene.error());
    Result<sim::InverseTask> task = robot::build_goals(scene->robot, scene->model);
    if (!task) return tl::unexpected(task.error());
    on_signal(OnSignal::ask);
    sim::StepperOptions stepping = sim::stepper_options(scene->robot.program);
    stepping.tolerance = tolerance_of(scene->robot);
    sim::Stepper stepper(scene->model, stepping);
    sim::inverse::InverseResult result = sim::inverse::follow(stepper, *task, {options.starts}, progress);
    return Solved{std::move(*scene), std::move(*task), std::move(result)};
}

/// With friction the way matters: what was found in one step is repeated in one step.
int steps_per_waypoint(const Solved& solved) {
    const bool has_friction =
        std::ranges::any_of(solved.scene.robot.cables, [](const auto& c) { return c.friction > 0; }) ||
        (solved.scene.robot.contact && solved.scene.robot.contact->friction > 0) ||
        std::ranges::any_of(solved.scene.robot.obstacles, [](const auto& o) { return o.friction > 0; });
    constexpr std::size_t fewest = 10;
    return has_friction ? 1 : static_cast<int>((fewest + solved.task.waypoints() - 1) / solved.task.waypoints());
}

Result<std::string> program_of(const Options& options, const Solved& solved, int steps_each) {
    std::vector<robot::ProgramPoint> points;
    for (const sim::inverse::Waypoint& at : solved.result.waypoints) {
        robot::ProgramPoint point{at.state.time, {}};
        for (std::size_t i = 0; i < at.values.size(); ++i)
            point.values.emplace_back(solved.task.inputs[i].name, at.values[i]);
        points.push_back(std::move(point));
    }
    return robot::program_text(solved.scene.robot, options.robot, options.assignments, options.folder, points,
                               steps_each, tolerance_of(solved.scene.robot));
}

/// Where the program led elsewhere than the waypoints were found, by more than their goals allow.
std::vector<std::string> departures(const Solved& solved, const sim::Trajectory& run, int steps_each) {
    std::vector<std::string> lines;
    if (!run.converged) lines.push_back("the program that was found does not run to its end: " + run.message);
    for (std::size_t k = 0; k < solved.result.waypoints.size(); ++k) {
        const std::size_t step = (k + 1) * static_cast<std::size_t>(steps_each);
        if (step >= run.steps.size()) break;
        for (const sim::Goal& goal : solved.task.goals) {
            for (const std::size_t marker : goal.markers) {
                const Vec3 there = run.steps[step].markers[marker].position_m;
                const double off = norm(there - solved.result.waypoints[k].state.markers[marker].position_m);
                if (goal.kind != sim::GoalKind::position || !(off > goal.tolerance)) continue;
                lines.push_back(
                    fmt::format("at waypoint {} the program leads marker \"{}\" {:.3g} mm from where it was "
                                "found: there is more than one equilibrium",
                                k + 1, run.steps[step].markers[marker].name, 1e3 * off));
            }
        }
    }
    return lines;
}

/// Runs the program that was found, as its file says, and writes everything.
Result<std::vector<std::string>> write_results(const Options& options, const Solved& solved, Progress& progress) {
    const int steps_each = steps_per_waypoint(solved);
    const Result<std::string> program = program_of(options, solved, steps_each);
    if (!program) return tl::unexpected(program.error());
    const std::filesystem::path file = std::filesystem::path(options.folder) / "program.toml";
    Result<robot::Robot> robot = robot::parse_robot(*program, file);
    if (!robot) return tl::unexpected(robot.error());
    const Result<robot::Scene> scene = robot::build_scene(std::move(*robot), progress);
    if (!scene) return tl::unexpected(scene.error());
    const sim::Trajectory run = sim::run(scene->model, scene->robot.program, progress);
    if (progress.cancelled()) return cancelled();
    report::Simulation simulation = report::simulation_of(scene->robot, scene->model, run);
    simulation.measured = report::wanted_paths(solved.report());
    simulation.measured_as = "wanted";
    const Status status =
        write_folder(options.folder, "summary.json", [&](const std::filesystem::path& path) -> Status {
            const auto written = report::write_results(path, simulation, {}, progress, progress);
            if (!written) return tl::unexpected(written.error());
            if (written->drawing_stopped) return cancelled();
            if (Status s = write_file(path / "program.toml", *program); !s) return s;
            if (Status s = write_file(path / "inverse.json", report::inverse_json(solved.report())); !s) return s;
            return write_file(path / "waypoints.csv", report::waypoints_csv(solved.report()));
        });
    if (!status) return tl::unexpected(status.error());
    return departures(solved, run, steps_each);
}

void print_text(const Options& options, const Solved& solved) {
    const report::InverseReport report = solved.report();
    fmt::print("{}, {}\n", counted(solved.scene.model.node_count(), "node"),
               counted(solved.scene.model.mesh().tet_count(),
                       solved.scene.model.mesh().order == 2 ? "quadratic tet" : "linear tet"));
    for (std::size_t k = 0; k < solved.result.waypoints.size(); ++k) {
        fmt::print("{}\n", waypoint_line(report, k));
        for (const sim::inverse::Limit& limit : solved.result.waypoints[k].limits) fmt::print("  {}\n", text(limit));
        const sim::inverse::Waypoint& at = solved.result.waypoints[k];
        if (!at.reached && at.limits.empty()) fmt::print("  the actuators move the robot in other directions only\n");
    }
    if (!options.folder.empty()) fmt::print("results: {}, open report.html there\n", options.folder);
}

Result<int> inverse(const Options& options) {
    auto progress = terminal_progress(options.output);
    on_signal(OnSignal::leave);
    const Result<Solved> solved = solve(options, *progress);
    if (!solved) return tl::unexpected(solved.error());
    const sim::inverse::InverseResult& result = solved->result;
    std::vector<std::string> warnings = result.notes;
    if (!options.folder.empty() && !result.waypoints.empty() && !result.cancelled) {
        const auto written = write_results(options, *solved, *progress);
        if (!written) return tl::unexpected(written.error());
        warnings.insert(warnings.end(), written->begin(), written->end());
    }
    progress.reset();
    if (options.output.json)
        fmt::print("{}", report::inverse_json(solved->report()));
    else if (!options.output.quiet)
        print_text(options, *solved);
    for (const std::string& warning : warnings) fmt::print(stderr, "{}: warning: {}\n", options.robot, warning);
    if (!result.message.empty()) fmt::print(stderr, "{}: {}\n", options.robot, result.message);
    return result.reached ? exit_done : exit_failed;
}

}  // namespace

void add_inverse(CLI::App& app, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("inverse", "what to pull so that the robot meets its goals");
    command->add_option("robot", options->robot, "robot file (TOML) with [[goal]], and ranges of actuators")
        ->required();
    command->add_option("-o,--output", options->folder,
                        "folder for the program that was found and its results; without it only a summary is printed");
    command
        ->add_option("--starts", options->starts,
                     "beginnings spread over the ranges that are tried where the way from rest does not reach")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    command->add_option("--set", options->assignments, "KEY=VALUE: change any key, as in goal.reach.tolerance=\"1 mm\"")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant inverse examples/inverse/trunk_helix/robot.toml -o out");
    on_call(*command, status, [options] { return inverse(*options); });
}

}  // namespace pliant::app
