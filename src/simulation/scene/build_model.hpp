// Builds a model from a robot file and its mesh.
#pragma once

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/robot.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/model/model.hpp"

namespace pliant::robot {

/// Attaches supports, plates, loads, cables, chambers and markers to the mesh of build_mesh(). The error has one line
/// per problem, each with file and line. `kept`: what points are attached to, for sim::Attacher.
[[nodiscard]] Result<sim::Model> build_model(const Robot& robot, mesh::TetMesh mesh, sim::KeptPatches* kept = nullptr);

}  // namespace pliant::robot
