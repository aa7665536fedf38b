// A robot with a little more and a little less of one number of its drawing, on the same mesh, moved along.
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
    double step = 0;           ///< by how much they differ
    std::vector<Vec3> motion;  ///< (nodes of the mesh) m for each unit of the number
};

/// `read`: reads the robot with these assignments on top of its own; `mesh`: of build_mesh(robot, ...), m. Differences
/// between the two, over `step`, are derivatives to about eight digits. Errors: of shape_motion(); the number decides
/// which nodes a support holds, or what there is at all; of a robot with another number.
[[nodiscard]] Result<NumberModels> number_models(
    const std::function<Result<Robot>(const std::vector<std::string>& assignments)>& read, const Robot& robot,
    const mesh::TetMesh& mesh, const std::string& parameter, double value);

}  // namespace pliant::robot
