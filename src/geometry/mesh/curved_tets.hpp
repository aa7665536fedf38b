// Volume and validity of quadratic tets with curved edges, and repair of invalid ones.
#pragma once

#include <cstddef>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// Smallest det dX/db of tet `t` over its corners, mid-edge points, face centres and centroid, divided by that of the
/// straight tet with the same corners: 1 for a straight tet, 0 or negative if it is folded there. Precondition: order
/// 2, and the straight tet has a positive volume.
[[nodiscard]] double worst_scaled_jacobian(const TetMesh& mesh, std::size_t t);

/// Volume of tet `t` with its curved edges; of a linear tet that of its corners.
[[nodiscard]] double curved_volume(const TetMesh& mesh, std::size_t t);

/// Moves the mid-edge nodes of every tet whose worst_scaled_jacobian() is below `least` to the midpoints of their
/// edges, and repeats until no such tet is left; other nodes stay on their curve. Returns the number of nodes moved.
/// Preconditions: order 2, all straight tets have positive volumes, least < 1.
std::size_t straighten_folded_tets(TetMesh& mesh, double least);

}  // namespace pliant::mesh
