// What may touch what, from the robot file to the solver.
#pragma once

#include "mesh/tet_mesh.hpp"
#include "robot/robot.hpp"
#include "sim/model.hpp"

namespace pliant::robot {

/// `bodies`: the tets that carry material, metres. Errors name the obstacle and its line. Precondition: the robot has
/// contact.
[[nodiscard]] Result<sim::ContactRules> build_contact(const Robot& robot, const mesh::TetMesh& bodies);

}  // namespace pliant::robot
