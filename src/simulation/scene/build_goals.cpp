#include "simulation/scene/build_goals.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/core/boxes.hpp"
#include "simulation/run/result_columns.hpp"

namespace pliant::robot {
namespace {

/// The reader of the file has checked the names; an index beyond the list would read foreign memory.
template <class List>
Result<std::size_t> index_of_named(const Robot& robot, const GoalSpec& goal, const List& list,
                                   const std::string& name) {
    const auto found = std::ranges::find_if(list, [&](const auto& entry) { return entry.name == name; });
    if (found == list.end())
        return input_error("{}: goal \"{}\": the robot has no \"{}\" that it could be for", robot.file.string(),
                           goal.name, name);
    return static_cast<std::size_t>(found - list.begin());
}

Result<sim::Goal> tied(const Robot& robot, const sim::Model& model, const GoalSpec& spec) {
    sim::Goal goal;
    goal.name = spec.name;
    goal.kind = spec.kind;
    goal.sum_of_sizes = spec.sum_of_sizes;
    goal.tolerance = spec.tolerance;
    goal.weight = spec.weight;
    for (const std::string& marker : spec.markers) {
        const Result<std::size_t> index = index_of_named(robot, spec, model.description().markers, marker);
        if (!index) return tl::unexpected(index.error());
        goal.markers.push_back(*index);
    }
    const bool contact = spec.kind == GoalSpec::Kind::contact_force;
    if (contact || spec.kind == GoalSpec::Kind::support_force) {
        const Result<std::size_t> index = contact ? index_of_named(robot, spec, robot.obstacles, spec.on)
                                                  : index_of_named(robot, spec, robot.fixed, spec.on);
        if (!index) return tl::unexpected(index.error());
        goal.on = *index;
    }
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

/// Markers at different points of the file may be carried by the same nodes in the same way, as the means of two boxes
/// are that hold the same nodes.
Status check_direction(const Robot& robot, const sim::Model& model, const sim::Goal& goal) {
    constexpr double at_one_point = 1e-9;  // times the robot's size
    if (goal.kind != GoalSpec::Kind::direction) return {};
    std::vector<double> x;
    for (const Vec3& point : model.mesh().points) x.insert(x.end(), {point.x, point.y, point.z});
    const sim::Marker& first = model.description().markers[goal.markers[0]];
    const sim::Marker& second = model.description().markers[goal.markers[1]];
    const double apart = norm(position(second.point, x) - position(first.point, x));
    if (apart > at_one_point * bounds_of(model.mesh().points).diagonal()) return {};
    return input_error("{}: goal \"{}\": markers \"{}\" and \"{}\" are at one point, which has no direction",
                       robot.file.string(), goal.name, first.name, second.name);
}

sim::Steered steered(std::size_t actuator, const std::string& name, const SteeringSpec& spec, bool ratio) {
    return {actuator, name, spec.low, spec.high, ratio ? 1.0 : 0.0, spec.rate, spec.effort_price, spec.change_price};
}

/// A ratio has no unit, so that its column in the table of results is called as its actuator.
template <class Spec>
Status check_column(const Robot& robot, const char* kind, const Spec& spec, bool is_ratio, bool need_goals) {
    const auto is_taken = [&](const auto& columns) { return std::ranges::find(columns, spec.name) != columns.end(); };
    if (!is_ratio || !(need_goals ? is_taken(sim::columns::waypoint) : is_taken(sim::columns::workspace))) return {};
    return input_error_at(robot.file.string(), spec.line,
                          "{} \"{}\": {} has a column of this name already; give the {} another name", kind, spec.name,
                          need_goals ? "waypoints.csv" : "workspace.csv", kind);
}

bool steers_ratio(const CableSpec& cable) {
    return cable.target.kind == CableTarget::Kind::length_ratio;
}
bool steers_ratio(const ChamberSpec& chamber) {
    const auto kind = chamber.target.kind;
    return kind == ChamberTarget::Kind::volume_ratio || kind == ChamberTarget::Kind::gas_ratio;
}

Status check_columns_of_inputs(const Robot& robot, bool need_goals) {
    for (const CableSpec& cable : robot.cables) {
        if (!cable.steering) continue;
        Status status = check_column(robot, "cable", cable, steers_ratio(cable), need_goals);
        if (!status) return status;
    }
    for (const ChamberSpec& chamber : robot.chambers) {
        if (!chamber.steering) continue;
        Status status = check_column(robot, "chamber", chamber, steers_ratio(chamber), need_goals);
        if (!status) return status;
    }
    return {};
}

/// For a program that `pliant inverse` wrote, above all: it passes the waypoints at 1 s, 2 s and so on.
std::string of_other_program(const Robot& robot) {
    const std::string file = robot.file.filename().string();
    return fmt::format(
        "goals have the times of the program in {0}, and the file that stands on it has another program; search with "
        "{0} itself, or give the goals times of this program, as --set goal.NAME.times=[1,2]",
        file);
}

std::vector<sim::Steered> steered_actuators(const Robot& robot) {
    std::vector<sim::Steered> inputs;
    for (std::size_t c = 0; c < robot.cables.size(); ++c) {
        const CableSpec& cable = robot.cables[c];
        if (cable.steering) inputs.push_back(steered(c, cable.name, *cable.steering, steers_ratio(cable)));
    }
    for (std::size_t c = 0; c < robot.chambers.size(); ++c) {
        const ChamberSpec& chamber = robot.chambers[c];
        if (chamber.steering)
            inputs.push_back(steered(robot.cables.size() + c, chamber.name, *chamber.steering, steers_ratio(chamber)));
    }
    return inputs;
}

}  // namespace

std::vector<std::string> notes_on_times(const Robot& robot) {
    const auto timed = std::ranges::find_if(robot.goals, [](const GoalSpec& goal) { return !goal.times.empty(); });
    if (!robot.times_of_other_program || timed == robot.goals.end()) return {};
    return {
        fmt::format("the times of goal \"{}\" may mean something else here: {}", timed->name, of_other_program(robot))};
}

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
            return input_error("{}: goal: \"{}\" {}; {}", robot.file.string(), goal.name, late,
                               robot.times_of_other_program ? of_other_program(robot) : "give program.duration");
    }
    sim::InverseTask task;
    task.inputs = steered_actuators(robot);
    if (task.inputs.empty())
        return input_error(
            "{}: range: no actuator has one; give a cable or chamber a range, such as range = [0.7, 1.0]",
            robot.file.string());
    if (Status columns = check_columns_of_inputs(robot, need_goals); !columns) return tl::unexpected(columns.error());
    std::size_t waypoints = 1;
    for (const GoalSpec& goal : robot.goals) {
        Result<sim::Goal> made = tied(robot, model, goal);
        if (!made) return tl::unexpected(made.error());
        task.goals.push_back(std::move(*made));
        if (Status near = check_near(robot, model, task.goals.back()); !near) return tl::unexpected(near.error());
        waypoints = std::max(waypoints, goal.wanted.size());
        if (!need_goals) continue;
        if (!goal.times.empty()) task.times = goal.times;
        if (Status apart = check_direction(robot, model, task.goals.back()); !apart)
            return tl::unexpected(apart.error());
    }
    if (!need_goals) waypoints = 1;
    task.timed = !task.times.empty();
    if (!task.timed) task.times.assign(waypoints, robot.program.duration);
    return task;
}

std::vector<std::string> notes_on_goals(const Robot& robot, const mesh::TetMesh& mesh) {
    constexpr double most_share = 0.05;
    const double size_m = bounds_of(mesh.points).diagonal();
    std::vector<std::string> notes;
    for (const GoalSpec& goal : robot.goals) {
        if (!goal.default_tolerance || !(goal.tolerance > most_share * size_m)) continue;
        notes.push_back(
            fmt::format("goal \"{}\" has no tolerance, and the default, 0.1 length_unit, is {:.3g} mm: {:.3g} % of the "
                        "robot's size. Everything nearer counts as reached; give one, as tolerance = \"{:.1g} mm\"",
                        goal.name, 1e3 * goal.tolerance, 100 * goal.tolerance / size_m, size_m));
    }
    return notes;
}

double goal_tolerance(const Program& program) {
    constexpr double tightest_needed = 1e-5;
    return std::min(program.tolerance, tightest_needed);
}

}  // namespace pliant::robot
