// How the nodes of a mesh move when a number of the drawing that it was made from changes.
//
// A node on the surface stays on its planes, spheres and cylinders, and on all of them where they meet. The remaining
// freedom, and the interior, follows a harmonic motion: least squares of its gradient. The mesh keeps its topology.
// docs/theory.md, "Gradients", explains the use.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// A robot read with the number slightly larger and slightly smaller; `step`: the difference.
struct DrawnAround {
    const Robot& more;
    const Robot& less;
    double step = 0;  ///< above zero
};

/// (nodes) m per unit of the number. `mesh`: from build_mesh(robot, ...), in metres. Zero for a robot with a mesh of
/// its own, which cannot follow a number that moves its features. Errors: bodies separate or overlap, so that no motion
/// of this mesh follows them; the number changes geometry read from a file.
[[nodiscard]] Result<std::vector<Vec3>> shape_motion(const Robot& robot, const DrawnAround& around,
                                                     const mesh::TetMesh& mesh);

}  // namespace pliant::robot
