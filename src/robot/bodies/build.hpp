// From a robot file to the inputs of the two wings: a tet mesh for the simulation, surfaces for the slicer.
#pragma once

#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// Meshes the bodies, or reads the mesh file. Metres. Regions as in regions_of(). Errors name the body and its line.
[[nodiscard]] Result<mesh::TetMesh> build_mesh(const Robot& robot, Progress& progress);

/// Uses a given mesh, in metres, in place of the file that the robot names: its regions become those of regions_of(),
/// its tets take the robot's order. Errors: the robot names no mesh file; those of build_mesh() about regions.
[[nodiscard]] Result<mesh::TetMesh> take_mesh(const Robot& robot, mesh::TetMesh mesh_m);

/// The closed surface of one body as drawn.
struct BodySurface {
    std::string body;
    int material = 0;  ///< index into Robot::materials
    mesh::TriMesh surface_m;
    std::vector<std::string> notes{};  ///< defects found or repaired in its file
    /// Only drawn bodies, which are cut out of it, can share space with it; chords deviate by this from common curved
    /// faces. 0: a shared space is one of the bodies as given.
    double chord_m = 0;
    /// The air of chambers and gaps in the body of a surface file that has too many faces to cut it out; may reach
    /// beyond it.
    std::vector<mesh::TriMesh> air_m{};
};
/// One for every body, in order, without the air of chambers and gaps, or with it beside. Errors name the body and its
/// line.
[[nodiscard]] Result<std::vector<BodySurface>> body_surfaces(const Robot& robot, Progress& progress);

}  // namespace pliant::robot
