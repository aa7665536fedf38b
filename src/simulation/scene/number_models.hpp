// Two copies of a robot with one number of its drawing slightly larger and smaller, on the same mesh, whose nodes
// follow.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/robot.hpp"
#include "simulation/model/model.hpp"

namespace pliant::robot {

struct NumberModels {
    sim::Model more, less;
    double step = 0;           ///< difference between the two values
    std::vector<Vec3> motion;  ///< (nodes of the mesh) m per unit of the number
};

/// `read`: reads the robot with these assignments in addition to its own; `mesh`: from build_mesh(robot, ...), m.
/// Differences between the two, divided by `step`, are derivatives to about eight digits: their points are attached to
/// the same nodes as those of `robot`. Errors: those of
/// shape_motion(); the number changes which nodes a support holds, or what the robot consists of; those of the modified
/// robots.
[[nodiscard]] Result<NumberModels> number_models(
    const std::function<Result<Robot>(const std::vector<std::string>& assignments)>& read, const Robot& robot,
    const mesh::TetMesh& mesh, const std::string& parameter, double value);

}  // namespace pliant::robot
