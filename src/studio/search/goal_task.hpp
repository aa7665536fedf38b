// Converts a goal set on the page into an inverse task for the current robot.
#pragma once

#include <string>

#include "simulation/parts/inverse_task.hpp"
#include "studio/requests/search_order.hpp"
#include "studio/simulate/simulation_session.hpp"

namespace pliant::studio {

/// The waypoints, at the end of the robot's program. Errors: there is no such marker or actuator; a range that is empty
/// or impossible for the actuator; a robot that moves in time.
[[nodiscard]] Result<sim::InverseTask> goal_task(const Built& built, const GoalOrder& order);

/// The workspace task for these inputs, at the end of the program. Errors: as above; no marker.
[[nodiscard]] Result<sim::InverseTask> workspace_task(const Built& built, const WorkspaceOrder& order);

/// JSON: the actuators that may be moved, with their ranges in the file or those of the page's sliders, in the units of
/// the page: [{"name", "kind", "low", "high"}, ...]; empty: the robot has no actuator.
[[nodiscard]] std::string goal_inputs_json(const Built& built);

}  // namespace pliant::studio
