// From a robot file to what the two wings take: a tet mesh for the simulation, surfaces for the slicer.
#pragma once

#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// Meshes the bodies, or reads the mesh file. Metres. Regions as in regions_of(). Errors name the body and its line.
[[nodiscard]] Result<mesh::TetMesh> build_mesh(const Robot& robot, Progress& progress);

/// A mesh that is at hand, in metres, in the place of the file that the robot names: its regions become those of
/// regions_of(), tets the robot's order. Errors: the robot names no mesh file; as build_mesh() of regions.
[[nodiscard]] Result<mesh::TetMesh> take_mesh(const Robot& robot, mesh::TetMesh mesh_m);

/// The closed surface of one body as drawn.
struct BodySurface {
    std::string body;
    int material = 0;  ///< index into Robot::materials
    mesh::TriMesh surface_m;
    std::vector<std::string> notes{};  ///< what was odd or mended in its file
};
/// One for every body, in their order, without the air of chambers and gaps. Errors name the body and its line.
[[nodiscard]] Result<std::vector<BodySurface>> body_surfaces(const Robot& robot, Progress& progress);

}  // namespace pliant::robot
