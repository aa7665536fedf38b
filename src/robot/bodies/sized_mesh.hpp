// How finely bodies are meshed: by the sizes that the robot file gives, or so that a step takes seconds.
#pragma once

#include <vector>

#include "base/core/progress.hpp"
#include "geometry/mesher/mesher.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// Gaps up to this width are closed, length units.
[[nodiscard]] double closed_gaps(const Robot& robot, const std::vector<mesh::BodyGeometry>& bodies);

/// Meshes the bodies. If the file gives no size, thin walls and many fingers must not produce a mesh on which every
/// step takes minutes: where the bodies are surely too large for it, a coarser one is made from the start, and a mesh
/// that turns out to have too many nodes is rebuilt with fewer elements through walls and then longer edges. A note
/// says so.
[[nodiscard]] Result<mesh::TetMesh> sized_mesh(const Robot& robot, const std::vector<mesh::BodyGeometry>& bodies,
                                               Progress& progress);

}  // namespace pliant::robot
