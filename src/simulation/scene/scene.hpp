// The one way from a robot to its model: what the library, the command line and the studio begin with.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "robot/description/robot.hpp"
#include "simulation/model/model.hpp"

namespace pliant::robot {

/// A robot and its model: all that there is before anything moves.
struct Scene {
    Robot robot;
    sim::Model model;
    std::vector<std::string> mesh_notes;  ///< what was done to the geometry, a sentence each
    double mesh_s = 0;                    ///< wall time of meshing, or of reading the mesh
    double model_s = 0;                   ///< and of tying everything to it
};

/// Meshes the bodies, or reads the mesh that the robot names, and builds the model. Errors: of build_mesh() and
/// build_model(); cancelled.
[[nodiscard]] Result<Scene> build_scene(Robot robot, Progress& progress);

/// The same with a mesh that is at hand, in metres. Errors: of take_mesh() and build_model().
[[nodiscard]] Result<Scene> build_scene(Robot robot, mesh::TetMesh mesh_m);

}  // namespace pliant::robot
