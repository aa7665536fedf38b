// Writes the folder of an InverseResult: the program is written, read back and run, just as users will run it.
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <numbers>
#include <utility>

#include "base/core/files.hpp"
#include "library/base/calls.hpp"
#include "library/simulation/drawing.hpp"
#include "library/simulation/inverse_data.hpp"
#include "presentation/report/results.hpp"
#include "robot/file/program_writer.hpp"
#include "robot/file/robot_document.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/scene/build_goals.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;

/// File name for a robot that was given as text, so that its program can refer to it.
constexpr const char* robot_name = "robot.toml";

/// The text of a program, and of the robot it is based on if that is not a file.
struct ProgramFiles {
    std::string program;
    std::string robot{};  ///< empty: a file
};

ProgramFiles program_files(const InverseResult::Data& found, const fs::path& folder, int steps_each) {
    std::vector<robot::ProgramPoint> points;
    for (const sim::inverse::Waypoint& at : found.result.waypoints) {
        if (at.is_unfinished()) continue;
        robot::ProgramPoint point{at.state.time, {}};
        for (std::size_t i = 0; i < at.values.size(); ++i)
            point.values.emplace_back(found.task.inputs[i].name, at.values[i]);
        points.push_back(std::move(point));
    }
    const robot::Robot& robot = found.model->scene.robot;
    const Robot::Data& given = *found.model->robot;
    const auto program = [&](const fs::path& file, const std::vector<std::string>& changes) {
        return library::value_of(robot::program_text(robot, file, changes, folder, points, steps_each,
                                                     robot::goal_tolerance(robot.program)));
    };
    if (given.has_file) return {program(given.file, given.changes)};
    return {program(folder / robot_name, {}),
            library::value_of(robot::robot_text(given.text, given.file, given.changes, folder))};
}

/// The robot of the program, on the given mesh or a new one.
robot::Scene scene_of(const InverseResult::Data& found, robot::Robot robot, Progress& progress) {
    const std::optional<mesh::TetMesh>& mesh = found.model->given_mesh;
    return library::value_of(mesh ? robot::build_scene(std::move(robot), *mesh)
                                  : robot::build_scene(std::move(robot), progress));
}

/// Results of the program for the goals: (waypoints), fewer if it stopped early.
using ProgramGoals = std::vector<std::vector<sim::inverse::GoalState>>;

/// Runs the program, which passes a waypoint after every `steps_each` steps.
sim::Trajectory run_program(const InverseResult::Data& found, const robot::Scene& scene, int steps_each,
                            ProgramGoals& goals, Progress& progress) {
    const sim::Equilibrium system(scene.model);
    sim::RunOptions options;
    options.checkpoint_every = steps_each;
    options.on_checkpoint = [&](const sim::RunState& at) -> Status {
        if (goals.size() < found.result.waypoints.size())
            goals.push_back(sim::inverse::goal_states(system, found.task, at.robot, goals.size()));
        return {};
    };
    return sim::run(scene.model, scene.robot.program, progress, std::move(options));
}

std::string shown_difference(const sim::Goal& goal, double size) {
    switch (goal.kind) {
        case sim::GoalKind::direction:
            return fmt::format("{:.3g} deg", 180 / std::numbers::pi * size);
        case sim::GoalKind::contact_force:
        case sim::GoalKind::support_force:
            return fmt::format("{:.3g} N", size);
        case sim::GoalKind::position:
        case sim::GoalKind::plane:
            break;
    }
    return fmt::format("{:.3g} mm", 1e3 * size);
}

/// Warnings for a goal that has `there` in the program and was found with `here`; none where they agree.
std::vector<std::string> departures_of(const InverseResult::Data& found, std::size_t goal, std::size_t waypoint,
                                       const sim::inverse::GoalState& there, const sim::inverse::GoalState& here) {
    const sim::Goal& wanted = found.task.goals[goal];
    std::vector<std::string> lines;
    if (wanted.kind != sim::GoalKind::position) {
        const double off = sim::inverse::difference(wanted, there, here, waypoint);
        if (off > wanted.tolerance)
            lines.push_back(
                fmt::format("at waypoint {} the program is {} from what was found for goal \"{}\": there is more than "
                            "one equilibrium",
                            waypoint + 1, shown_difference(wanted, off), wanted.name));
        return lines;
    }
    for (std::size_t m = 0; m < wanted.markers.size(); ++m) {
        const double off = norm(there.got[m] - here.got[m]);
        if (!(off > wanted.tolerance)) continue;
        lines.push_back(fmt::format(
            "at waypoint {} the program leads marker \"{}\" {} from where it was found: there is more than one "
            "equilibrium",
            waypoint + 1, found.model->scene.model.description().markers[wanted.markers[m]].name,
            shown_difference(wanted, off)));
    }
    return lines;
}

/// Warnings for waypoints where the program deviates from the results by more than the goals' tolerances.
std::vector<std::string> departures(const InverseResult::Data& found, const sim::Trajectory& run,
                                    const ProgramGoals& goals) {
    std::vector<std::string> lines;
    if (!run.converged) lines.push_back("the program that was found does not run to its end: " + run.message);
    for (std::size_t k = 0; k < goals.size(); ++k) {
        for (std::size_t g = 0; g < goals[k].size(); ++g) {
            for (std::string& line : departures_of(found, g, k, goals[k][g], found.result.waypoints[k].goals[g]))
                lines.push_back(std::move(line));
        }
    }
    return lines;
}

/// Writes the program, runs it from its file, and writes all results. Returns the warnings of departures(), and one if
/// nothing could be drawn.
std::vector<std::string> fill(const InverseResult::Data& found, const fs::path& folder, const fs::path& final_folder,
                              Progress& progress, library::Drawing& drawing) {
    const int steps_each = robot::steps_per_point(found.model->scene.robot, found.task.waypoints());
    const ProgramFiles files = program_files(found, final_folder, steps_each);
    if (!files.robot.empty()) library::check(write_file(folder / robot_name, files.robot));
    library::check(write_file(folder / "program.toml", files.program));
    const robot::Scene scene = scene_of(found, library::value_of(robot::load_robot(folder / "program.toml")), progress);
    ProgramGoals goals;
    const sim::Trajectory run = run_program(found, scene, steps_each, goals, progress);
    if (progress.cancelled()) library::check(cancelled());
    report::Simulation simulation = report::simulation_of(scene.robot, scene.model, run);
    simulation.measured = report::wanted_paths(found.report());
    simulation.measured_as = "wanted";
    const auto written = library::value_of(report::write_results(folder, simulation, {}, progress, drawing));
    drawing.rethrow();
    if (progress.cancelled()) library::check(cancelled());
    std::vector<std::string> warnings = departures(found, run, goals);
    if (!written.warning.empty()) warnings.push_back(written.warning);
    library::check(write_file(folder / "inverse.json", report::inverse_json(found.report(), warnings)));
    library::check(write_file(folder / "waypoints.csv", report::waypoints_csv(found.report())));
    return warnings;
}

}  // namespace

std::vector<std::string> InverseResult::write(const fs::path& folder, const Watch& watch,
                                              const std::function<bool()>& enough_pictures) const {
    if (data_->result.waypoints.empty())
        throw Failure(Failure::Kind::failed, "there is nothing to write: " + message());
    data_->model->robot->check_outside(folder);
    library::WatchedProgress progress(watch, "results");
    library::Drawing drawing(progress, enough_pictures);
    std::vector<std::string> warnings;
    std::exception_ptr thrown;
    const Status status = write_folder(folder, report::inverse_mark(), [&](const fs::path& aside) -> Status {
        try {
            warnings = fill(*data_, aside, folder, progress, drawing);
        } catch (...) {
            thrown = std::current_exception();
            return cancelled();
        }
        return {};
    });
    progress.rethrow();
    if (thrown) std::rethrow_exception(thrown);
    library::check(status);
    return warnings;
}

}  // namespace pliant
