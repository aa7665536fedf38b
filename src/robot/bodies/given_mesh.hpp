// Meshes that are given instead of drawn: which of their regions are which bodies, chambers and gaps.
#pragma once

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// Assigns every region of a given mesh, in length units, to the body, chamber or gap that names it. Errors: a region
/// that nobody names or that two name, tets that overlap.
[[nodiscard]] Result<mesh::TetMesh> give_regions(const Robot& robot, mesh::TetMesh mesh);

/// The mesh of the file that the robot names, in length units. Errors: those of the file and of give_regions().
[[nodiscard]] Result<mesh::TetMesh> read_mesh_file(const Robot& robot);

}  // namespace pliant::robot
