// A page's goal as a task for the robot at hand.
#pragma once

#include <string>

#include "presentation/studio/search_order.hpp"
#include "presentation/studio/simulation_session.hpp"
#include "simulation/parts/inverse_task.hpp"

namespace pliant::studio {

/// At the end of the robot's program, waypoint by waypoint. Errors: there is no such marker or actuator; an empty
/// range, or one that the actuator cannot have; a robot that moves in time.
[[nodiscard]] Result<sim::InverseTask> goal_task(const Built& built, const GoalOrder& order);

/// Where the markers can get with these inputs, at the end of the program. Errors: as above; no marker.
[[nodiscard]] Result<sim::InverseTask> workspace_task(const Built& built, const WorkspaceOrder& order);

/// JSON: the actuators that may be moved, with their ranges in the file or those of the page's sliders, in the units of
/// the page: [{"name", "kind", "low", "high"}, ...]; empty: the robot has no actuator.
[[nodiscard]] std::string goal_inputs_json(const Built& built);

}  // namespace pliant::studio
