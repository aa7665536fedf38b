#include "pliant/inverse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "library/base/calls.hpp"
#include "library/simulation/inverse_data.hpp"
#include "library/simulation/steering.hpp"
#include "robot/file/program_writer.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/scene/build_goals.hpp"

namespace pliant {
namespace {

const char* unit_of_goal(const sim::Goal& goal) {
    switch (goal.kind) {
        case sim::GoalKind::direction:
            return "rad";
        case sim::GoalKind::contact_force:
        case sim::GoalKind::support_force:
            return "N";
        default:
            return "m";
    }
}

GoalResult goal_result(const sim::Goal& goal, const sim::inverse::GoalState& state, std::size_t waypoint) {
    return {goal.name,
            state.reached,
            state.error,
            unit_of_goal(goal),
            library::points_of(goal.at(waypoint)),
            library::points_of(state.got)};
}

[[noreturn]] void no_waypoint(std::size_t index, std::size_t count) {
    throw Failure(Failure::Kind::input, fmt::format("there is no waypoint {}; there are {}", index, count));
}

/// Throws if no program could name what it would have to.
void check_writable(const Model::Data& model, const sim::InverseTask& task) {
    std::vector<std::string> names;
    for (const sim::Steered& input : task.inputs) names.push_back(input.name);
    library::check(robot::check_program_names(model.scene.robot, model.robot->file, names, task.times));
}

}  // namespace

InverseResult inverse(const Model& model, const InverseOptions& options, const Watch& watch) {
    constexpr int most_starts = 100000;
    if (options.starts < 0 || options.starts > most_starts)
        throw Failure(Failure::Kind::input,
                      fmt::format("{} starts are not possible; 0 to {} are", options.starts, most_starts));
    const robot::Scene& scene = model.data()->scene;
    sim::InverseTask task = library::value_of(robot::build_goals(scene.robot, scene.model));
    if (options.to_write) check_writable(*model.data(), task);
    sim::StepperOptions stepping = sim::stepper_options(scene.robot.program);
    stepping.tolerance = robot::goal_tolerance(scene.robot.program);
    sim::Stepper stepper(scene.model, stepping);
    library::WatchedProgress progress(watch, "finding inputs");
    sim::inverse::InverseResult found = sim::inverse::follow(stepper, task, {options.starts}, progress);
    progress.rethrow();
    if (found.cancelled && found.waypoints.empty()) library::check(cancelled());
    std::ranges::copy(robot::notes_on_goals(scene.robot, scene.model.mesh()), std::back_inserter(found.notes));
    std::ranges::copy(robot::notes_on_times(scene.robot), std::back_inserter(found.notes));
    std::vector<SteeredInput> inputs = library::steered_inputs(scene.model, task);
    return InverseResult(std::make_shared<const InverseResult::Data>(
        InverseResult::Data{model.data(), std::move(task), std::move(found), std::move(inputs),
                            std::make_shared<const sim::Equilibrium>(scene.model)}));
}

InverseResult::InverseResult(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

bool InverseResult::reached() const {
    return data_->result.reached;
}
const std::string& InverseResult::message() const {
    return data_->result.message;
}
const std::vector<std::string>& InverseResult::notes() const {
    return data_->result.notes;
}
const std::vector<SteeredInput>& InverseResult::inputs() const {
    return data_->inputs;
}
std::size_t InverseResult::waypoints_wanted() const {
    return data_->task.waypoints();
}
std::size_t InverseResult::waypoint_count() const {
    return data_->result.waypoints.size();
}

Waypoint InverseResult::waypoint(std::size_t index) const {
    if (index >= waypoint_count()) no_waypoint(index, waypoint_count());
    const sim::inverse::Waypoint& at = data_->result.waypoints[index];
    Waypoint out;
    out.reached = at.reached;
    out.time = at.state.time;
    for (std::size_t g = 0; g < at.goals.size(); ++g)
        out.goals.push_back(goal_result(data_->task.goals[g], at.goals[g], index));
    out.inputs = at.values;
    out.limits = sim::inverse::reasons(at);
    out.result = library::result_of(at.state);
    out.observed = library::observation_of(at.state);
    out.positions = library::points_of(at.state.positions);
    out.forward_solutions = at.work.forward;
    out.wall_s = at.wall_s;
    return out;
}

Inputs InverseResult::inputs_at(std::size_t index) const {
    if (index >= waypoint_count()) no_waypoint(index, waypoint_count());
    const sim::inverse::Waypoint& at = data_->result.waypoints[index];
    return library::inputs_at(*data_->system, data_->task, at.values, at.state.time);
}

std::string InverseResult::text() const {
    std::string lines;
    for (std::size_t k = 0; k < waypoint_count(); ++k) {
        const sim::inverse::Waypoint& at = data_->result.waypoints[k];
        lines += report::waypoint_line(data_->report(), k) + "\n";
        for (const std::string& reason : sim::inverse::reasons(at)) lines += "  " + reason + "\n";
    }
    return lines;
}

std::string InverseResult::json(const std::vector<std::string>& warnings) const {
    return report::inverse_json(data_->report(), warnings);
}

}  // namespace pliant
