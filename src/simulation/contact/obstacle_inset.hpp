// Obstacles inset a little, so that the robot comes to rest where they are drawn.
#pragma once

#include <optional>
#include <vector>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::sim::contact {

/// Surfaces pressed on each other stay apart: at a pressure of 0.02 Young's moduli (with the usual stiffness) by this
/// share of the distance at which forces begin, at 0.001 and 0.1 by 0.98 and 0.78 of it. Obstacles are inset by the
/// same share.
inline constexpr double resting_share = 0.9;

/// The points with every face moved inwards by `depth`, in the unit of the mesh; corners where three faces meet keep
/// their angles. Empty if the surface is not closed or not twice as thick.
[[nodiscard]] std::optional<std::vector<Vec3>> inset(const mesh::TriMesh& surface, double depth);

}  // namespace pliant::sim::contact
