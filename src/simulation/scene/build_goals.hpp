// The goals of a robot file, and the actuators that have a range, tied to its model.
#pragma once

#include "base/core/error.hpp"
#include "robot/description/robot.hpp"
#include "simulation/model/model.hpp"
#include "simulation/parts/inverse_task.hpp"

namespace pliant::robot {

/// `model`: of build_model(robot, ...). With `need_goals` a robot without goals is an error, else the task may have
/// none, and one waypoint at the end of the program. Errors: no actuator has a range; the robot moves in time.
[[nodiscard]] Result<sim::InverseTask> build_goals(const Robot& robot, const sim::Model& model, bool need_goals = true);

}  // namespace pliant::robot
