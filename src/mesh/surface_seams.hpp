// Surfaces that are open only because a point was written twice, once a little beside the other.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// Edges between two points, lower first, that triangles do not pass as often one way as the other, ascending: the
/// border of the surface.
[[nodiscard]] std::vector<std::pair<int, int>> border_edges(const TriMesh& surface);

/// Joins points of the border that are no farther apart than rounding to 32 bits may put them, a millionth of the
/// surface's size, and drops triangles that have become edges: programs reckon a point once for each triangle and
/// arrive at different last digits. The number of border edges that are gone; the surface stays as it was if there are
/// none.
std::size_t close_seams(TriMesh& surface);

}  // namespace pliant::mesh
