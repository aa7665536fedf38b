// Where a point of space lies in a quadratic tet: the map of its shape functions, inverted.
#pragma once

#include <array>
#include <span>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// The ten nodes of a quadratic tet, corners first.
using TetNodes = std::array<Vec3, 10>;
/// Of a linear tet: with the middles of its edges.
[[nodiscard]] TetNodes nodes_of(const TetMesh& mesh, std::size_t tet);

/// Barycentric coordinates -> space, and its derivative: column k is dX / db_k.
[[nodiscard]] Vec3 curved_position(const TetNodes& nodes, const std::array<double, 4>& b);
[[nodiscard]] std::array<Vec3, 4> curved_derivative(const TetNodes& nodes, const std::array<double, 4>& b);

/// A box that holds the whole tet, however its edges are curved: that of its Bezier points.
[[nodiscard]] Box3 curved_bounds(const TetNodes& nodes);

struct CurvedPoint {
    std::array<double, 4> barycentric{};  ///< sum 1, none negative
    double distance = 0;                  ///< from the point that was asked for to where these lie; rounding inside
};

/// The point of the tet that is nearest to `p`: each step takes the nearest point of the tet that touches the map where
/// the last one ended (Gauss and Newton, on the simplex), and goes as far as the distance falls. Inside a tet that is
/// not folded this is Newton's method for the inverse of the map. Ends for every tet, degenerate or folded, with a
/// point that is not farther than the one of the straight tet.
[[nodiscard]] CurvedPoint nearest_in_curved_tet(const TetNodes& nodes, const Vec3& p);

}  // namespace pliant::mesh
