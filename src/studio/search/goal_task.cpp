#include "studio/search/goal_task.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "presentation/scene/actuator_kind.hpp"
#include "simulation/solver/equilibrium.hpp"
#include "studio/base/dumped.hpp"
#include "studio/simulate/led_marker.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

/// All actuators that could be moved, each once, and the lengths and volumes of all at rest.
struct Possible {
    std::vector<double> rest_measures;
    std::vector<sim::Steered> inputs;
};

Possible possible_inputs(const Built& built) {
    const sim::Equilibrium system(built.model);
    Possible possible;
    for (const sim::Actuator& actuator : system.actuators()) possible.rest_measures.push_back(actuator.rest_measure());
    possible.inputs = led_inputs(built.robot, built.model, possible.rest_measures);
    return possible;
}

/// Lengths, volumes and ratios must be positive, and cables cannot push.
bool is_possible(const sim::Steered& input, const view::ActuatorKind& kind, double rest) {
    const std::string_view name = kind.name;
    if (name == "shortening_mm") return input.high < rest;
    if (name == "volume_change_mm3") return input.low > -rest;
    if (name == "pressure_kPa") return true;
    return name == "tension_N" ? input.low >= 0 : input.low > 0;
}

Result<sim::Steered> steered(const Built& built, const Possible& possible, const InputRange& range) {
    const auto found = std::ranges::find(possible.inputs, range.name, &sim::Steered::name);
    if (found == possible.inputs.end())
        return input_error("{}: cannot be moved: there is no such actuator", range.name);
    const sim::Description& d = built.model.description();
    const view::ActuatorKind kind = view::kind_of(d, found->actuator);
    sim::Steered input = *found;
    input.low = range.low / kind.per_unit;
    input.high = range.high / kind.per_unit;
    if (!(input.low < input.high))
        return input_error("{}: the range from {:g} to {:g} is empty", range.name, range.low, range.high);
    if (!is_possible(input, kind, possible.rest_measures[input.actuator]))
        return input_error("{}: the range from {:g} to {:g} has values that are not possible", range.name, range.low,
                           range.high);
    return input;
}

Status add_inputs(const Built& built, const std::vector<InputRange>& ranges, sim::InverseTask& task) {
    const Possible possible = possible_inputs(built);
    for (const InputRange& range : ranges) {
        Result<sim::Steered> input = steered(built, possible, range);
        if (!input) return tl::unexpected(input.error());
        const auto is_it = [&](const sim::Steered& other) { return other.actuator == input->actuator; };
        if (std::ranges::any_of(task.inputs, is_it)) return input_error("{}: is named twice", range.name);
        task.inputs.push_back(std::move(*input));
    }
    return {};
}

}  // namespace

Result<sim::InverseTask> workspace_task(const Built& built, const WorkspaceOrder& order) {
    if (built.robot.program.dynamics)
        return input_error("program: time_step: a workspace is that of a robot at rest; leave it out");
    if (built.model.description().markers.empty())
        return input_error("a workspace is where markers can get, and this robot has no [[marker]]");
    sim::InverseTask task;
    if (Status status = add_inputs(built, order.inputs, task); !status) return tl::unexpected(status.error());
    task.times = {built.robot.program.duration};
    return task;
}

Result<sim::InverseTask> goal_task(const Built& built, const GoalOrder& order) {
    if (built.robot.program.dynamics)
        return input_error("program: time_step: goals are for a robot at rest at every waypoint; leave it out");
    const auto& markers = built.model.description().markers;
    const auto marker = std::ranges::find(markers, order.marker, &sim::Marker::name);
    if (marker == markers.end()) return input_error("{}: there is no such marker", order.marker);
    sim::Goal goal;
    goal.name = order.marker;
    goal.markers = {static_cast<std::size_t>(marker - markers.begin())};
    goal.tolerance = 1e-3 * order.tolerance_mm;
    for (const auto& [x, y, z] : order.path_mm) goal.wanted.push_back({1e-3 * Vec3{x, y, z}});
    sim::InverseTask task;
    task.goals = {std::move(goal)};
    if (Status status = add_inputs(built, order.inputs, task); !status) return tl::unexpected(status.error());
    task.times.assign(order.path_mm.size(), built.robot.program.duration);
    return task;
}

std::string goal_inputs_json(const Built& built) {
    const sim::Description& d = built.model.description();
    Json list = Json::array();
    const Possible possible = possible_inputs(built);
    for (const sim::Steered& input : possible.inputs) {
        const view::ActuatorKind kind = view::kind_of(d, input.actuator);
        list.push_back({{"name", input.name},
                        {"kind", kind.name},
                        {"low", kind.per_unit * input.low},
                        {"high", kind.per_unit * input.high}});
    }
    return dumped(list);
}

}  // namespace pliant::studio
