// Inverse of the shape-function map of a quadratic tet: finds a point's barycentric coordinates.
#pragma once

#include <array>
#include <span>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// The ten nodes of a quadratic tet, corners first.
using TetNodes = std::array<Vec3, 10>;
/// For a linear tet, mid-edge nodes are the midpoints of its edges.
[[nodiscard]] TetNodes nodes_of(const TetMesh& mesh, std::size_t tet);

/// Barycentric coordinates -> space, and its derivative: column k is dX / db_k.
[[nodiscard]] Vec3 curved_position(const TetNodes& nodes, const std::array<double, 4>& b);
[[nodiscard]] std::array<Vec3, 4> curved_derivative(const TetNodes& nodes, const std::array<double, 4>& b);

/// A box that contains the whole tet, however curved its edges: the bounds of its Bezier points.
[[nodiscard]] Box3 curved_bounds(const TetNodes& nodes);

struct CurvedPoint {
    std::array<double, 4> barycentric{};  ///< sum 1, none negative
    double distance = 0;                  ///< from the query point to the point of these coordinates; rounding error if
                                          ///< inside
};

/// The point of the tet nearest to `p`: Gauss-Newton on the simplex. Each step projects onto the tet tangent to the map
/// at the last iterate and is shortened until the distance decreases. Inside an unfolded tet this is Newton's method
/// for the inverse map. Terminates for every tet, degenerate or folded, with a point no farther than that of the
/// straight tet.
[[nodiscard]] CurvedPoint nearest_in_curved_tet(const TetNodes& nodes, const Vec3& p);

}  // namespace pliant::mesh
