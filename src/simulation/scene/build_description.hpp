// From a robot file and its mesh to what a model is made from.
#pragma once

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/robot.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::robot {

/// As build_model(), without the checks and the arrays of sim::Model: for what is spread over many machines.
[[nodiscard]] Result<sim::Description> build_description(const Robot& robot, mesh::TetMesh mesh,
                                                         sim::KeptPatches* kept = nullptr);

}  // namespace pliant::robot
