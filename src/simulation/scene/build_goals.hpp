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

/// Of a program's steps where they are compared with goals: an equilibrium has to be nearer to one than its tolerance
/// is wide.
[[nodiscard]] double goal_tolerance(const Program& program);

}  // namespace pliant::robot
