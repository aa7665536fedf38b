#include "simulation/scene/build_goals.hpp"

#include <algorithm>

#include "base/core/boxes.hpp"

namespace pliant::robot {
namespace {

template <class List>
std::size_t index_of_known(const List& list, const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find_if(list, [&](const auto& entry) { return entry.name == name; }) -
                                    list.begin());
}

sim::Goal tied(const Robot& robot, const sim::Model& model, const GoalSpec& spec) {
    sim::Goal goal;
    goal.name = spec.name;
    goal.kind = spec.kind;
    goal.sum_of_sizes = spec.sum_of_sizes;
    goal.tolerance = spec.tolerance;
    goal.weight = spec.weight;
    for (const std::string& marker : spec.markers)
        goal.markers.push_back(index_of_known(model.description().markers, marker));
    if (spec.kind == GoalSpec::Kind::contact_force) goal.on = index_of_known(robot.obstacles, spec.on);
    if (spec.kind == GoalSpec::Kind::support_force) goal.on = index_of_known(robot.fixed, spec.on);
    goal.wanted = spec.wanted;
    for (std::vector<Vec3>& at : goal.wanted) {
        if (spec.kind == GoalSpec::Kind::plane) at[0] = robot.unit_m * at[0];
        if (spec.kind != GoalSpec::Kind::position) continue;
        for (Vec3& point : at) point = robot.unit_m * point;
    }
    return goal;
}

/// Farther away rounding hides which inputs come nearer.
constexpr double far_sizes = 1e6;  // times the robot's size

Status check_near(const Robot& robot, const sim::Model& model, const sim::Goal& goal) {
    if (goal.kind != GoalSpec::Kind::position && goal.kind != GoalSpec::Kind::plane) return {};
    const Box3 box = bounds_of(model.mesh().points);
    for (const std::vector<Vec3>& at : goal.wanted) {
        const std::size_t points = goal.kind == GoalSpec::Kind::plane ? 1 : at.size();
        for (std::size_t k = 0; k < points; ++k) {
            if (norm(at[k] - 0.5 * (box.low + box.high)) <= far_sizes * box.diagonal()) continue;
            return input_error(
                "{}: goal \"{}\": its point [{:.4g}, {:.4g}, {:.4g}] is over a million times as far away as the robot "
                "is large; a point in the same direction, but nearer, asks for the same",
                robot.file.string(), goal.name, at[k].x / robot.unit_m, at[k].y / robot.unit_m, at[k].z / robot.unit_m);
        }
    }
    return {};
}

sim::Steered steered(std::size_t actuator, const std::string& name, const SteeringSpec& spec, bool ratio) {
    return {actuator, name, spec.low, spec.high, ratio ? 1.0 : 0.0, spec.rate, spec.effort_price, spec.change_price};
}

std::vector<sim::Steered> steered_actuators(const Robot& robot) {
    std::vector<sim::Steered> inputs;
    for (std::size_t c = 0; c < robot.cables.size(); ++c) {
        const CableSpec& cable = robot.cables[c];
        if (cable.steering)
            inputs.push_back(
                steered(c, cable.name, *cable.steering, cable.target.kind == CableTarget::Kind::length_ratio));
    }
    for (std::size_t c = 0; c < robot.chambers.size(); ++c) {
        const ChamberSpec& chamber = robot.chambers[c];
        const auto kind = chamber.target.kind;
        if (chamber.steering)
            inputs.push_back(
                steered(robot.cables.size() + c, chamber.name, *chamber.steering,
                        kind == ChamberTarget::Kind::volume_ratio || kind == ChamberTarget::Kind::gas_ratio));
    }
    return inputs;
}

}  // namespace

Result<sim::InverseTask> build_goals(const Robot& robot, const sim::Model& model, bool need_goals) {
    if (robot.program.dynamics)
        return input_error("{}: program: time_step: {}; leave it out", robot.file.string(),
                           need_goals ? "goals are for a robot at rest at every waypoint"
                                      : "the states within the ranges of actuators are those of a robot at rest");
    if (need_goals && robot.goals.empty())
        return input_error("{}: goal: there is none; add a [[goal]] with marker = \"NAME\" and point = [x, y, z]",
                           robot.file.string());
    for (const GoalSpec& goal : robot.goals) {
        const std::string late = late_time(goal, robot.program.duration);
        if (need_goals && !late.empty())
            return input_error("{}: goal: \"{}\" {}", robot.file.string(), goal.name, late);
    }
    sim::InverseTask task;
    task.inputs = steered_actuators(robot);
    if (task.inputs.empty())
        return input_error(
            "{}: range: no actuator has one; give a cable or chamber a range, such as range = [0.7, 1.0]",
            robot.file.string());
    std::size_t waypoints = 1;
    for (const GoalSpec& goal : robot.goals) {
        task.goals.push_back(tied(robot, model, goal));
        if (Status near = check_near(robot, model, task.goals.back()); !near) return tl::unexpected(near.error());
        waypoints = std::max(waypoints, goal.wanted.size());
        if (need_goals && !goal.times.empty()) task.times = goal.times;
    }
    if (!need_goals) waypoints = 1;
    task.timed = !task.times.empty();
    if (!task.timed) task.times.assign(waypoints, robot.program.duration);
    return task;
}

double goal_tolerance(const Program& program) {
    constexpr double tightest_needed = 1e-5;
    return std::min(program.tolerance, tightest_needed);
}

}  // namespace pliant::robot
