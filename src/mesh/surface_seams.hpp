// The borders of surfaces, and those that are there only because a point was written twice, once a little beside the
// other.
#pragma once

#include <cstddef>
#include <vector>

#include "mesh/tri_mesh.hpp"

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

/// Joins points of the border that are no farther apart than rounding to 32 bits may put them, a millionth of the
/// surface's size, and drops triangles that have become edges: programs reckon a point once for each triangle and
/// arrive at different last digits. The number of border edges that are gone; the surface stays as it was if there are
/// none.
std::size_t close_seams(TriMesh& surface);

}  // namespace pliant::mesh
