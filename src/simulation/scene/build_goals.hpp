// Builds the inverse task from a robot file: goals, and the actuators that have a range.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/robot.hpp"
#include "simulation/model/model.hpp"
#include "simulation/parts/inverse_task.hpp"

namespace pliant::robot {

/// `model`: from build_model(robot, ...). With `need_goals` a robot without goals is an error; otherwise the task may
/// have none, and has one waypoint, at the end of the program, whatever times goals have. Errors: no actuator has a
/// range, or one has the name of a column that the table of results has anyway; the robot moves in time; with
/// `need_goals`, a goal has a time after the end of the program.
[[nodiscard]] Result<sim::InverseTask> build_goals(const Robot& robot, const sim::Model& model, bool need_goals = true);

/// Goals that count as reached where the robot is far from them, because the file gives no tolerance and has a large
/// length unit.
[[nodiscard]] std::vector<std::string> notes_on_goals(const Robot& robot, const mesh::TetMesh& mesh);

/// Goals with times of another program than the one that the robot has from a file that stands on its own.
[[nodiscard]] std::vector<std::string> notes_on_times(const Robot& robot);

/// Solver tolerance for a program whose steps are compared with goals: the error of an equilibrium must be smaller than
/// the tolerance of a goal.
[[nodiscard]] double goal_tolerance(const Program& program);

}  // namespace pliant::robot
