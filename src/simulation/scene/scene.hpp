// Builds a model from a robot: the common entry point of the library, the command line and the studio.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "robot/description/robot.hpp"
#include "simulation/model/model.hpp"

namespace pliant::robot {

/// A robot and its model, before any step.
struct Scene {
    Robot robot;
    sim::Model model;
    std::vector<std::string> mesh_notes;  ///< changes made to the geometry, one sentence each
    double mesh_s = 0;                    ///< wall time of meshing, or of reading the mesh
    double model_s = 0;                   ///< wall time of building the model
};

/// Meshes the bodies, or reads the mesh that the robot names, and builds the model. Errors: those of build_mesh() and
/// build_model(); cancelled.
[[nodiscard]] Result<Scene> build_scene(Robot robot, Progress& progress);

/// The same with a given mesh, in metres. Errors: those of take_mesh() and build_model().
[[nodiscard]] Result<Scene> build_scene(Robot robot, mesh::TetMesh mesh_m);

}  // namespace pliant::robot
