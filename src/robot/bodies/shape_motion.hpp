// How the nodes of a mesh move with a number of the drawing that it was made from.
//
// A node on the surface stays on the planes, spheres and cylinders that it is on; where they meet, on all of them. What
// that leaves free, and the inside, moves as smoothly as it can: least squares of its gradient (a harmonic motion). The
// mesh keeps its topology. docs/theory.md, "Gradients", says what for.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// A robot that was read with the number a little larger and a little smaller; `step`: how much they differ.
struct DrawnAround {
    const Robot& more;
    const Robot& less;
    double step = 0;  ///< above zero
};

/// (nodes) m for each unit of the number. `mesh`: of build_mesh(robot, ...), in metres. Errors: bodies come apart, or
/// into each other, so that no motion of this mesh follows them; the number moves geometry of a file; a robot with a
/// mesh of its own whose places it moves has none that could follow, and gives no motion.
[[nodiscard]] Result<std::vector<Vec3>> shape_motion(const Robot& robot, const DrawnAround& around,
                                                     const mesh::TetMesh& mesh);

}  // namespace pliant::robot
