// The borders of surfaces, and those that are there only because a point was written twice, once a little beside the
// other.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// Where a surface ends: its triangles run `times` more often from `from` to `to` than back.
struct BorderEdge {
    int from, to;
    int times;  ///< 1 or more
};

/// The border of the surface, in ascending order of the edges' lower, then higher ends.
[[nodiscard]] std::vector<BorderEdge> border_edges(const TriMesh& surface);

/// Triangles that the surface lacks to have no border: from each connected piece of the border to its middle. Their
/// points are those of the surface and then the middles.
[[nodiscard]] TriMesh border_caps(const TriMesh& surface);

struct ClosedSeams {
    std::size_t edges = 0;   ///< of the border, that are gone
    std::size_t points = 0;  ///< that became another one
};

/// Joins points of the border that are no farther apart than `reach` and drops triangles that have become edges, and
/// points that no triangle uses any more: programs reckon a point once for each triangle and arrive at different last
/// digits. No point moves by more than `reach`, however many lie in a row. The surface stays as it was if its border
/// does not get shorter, or nothing would be left of it.
ClosedSeams close_seams(TriMesh& surface, double reach);

/// The same for what rounding to 32 bits may do to points, a millionth of the surface's size.
ClosedSeams close_seams(TriMesh& surface);

}  // namespace pliant::mesh
