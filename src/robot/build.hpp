// From a robot file to what the two wings take: a tet mesh and a model for the simulation, surfaces for the slicer.
#pragma once

#include <string>
#include <vector>

#include "core/progress.hpp"
#include "mesh/tet_mesh.hpp"
#include "robot/robot.hpp"
#include "sim/model.hpp"

namespace pliant::robot {

/// Meshes the bodies, or reads the mesh file. Metres. Regions as in regions_of(). Errors name the body and its line.
[[nodiscard]] Result<mesh::TetMesh> build_mesh(const Robot& robot, Progress& progress);

/// Ties supports, plates, loads, cables, chambers and markers to the mesh of build_mesh(). An error holds one line per
/// problem, each with file and line.
[[nodiscard]] Result<sim::Model> build_model(const Robot& robot, mesh::TetMesh mesh);

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
