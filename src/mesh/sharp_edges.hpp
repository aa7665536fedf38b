// The sharp edges of a surface, for a mesher that must be told of them.
#pragma once

#include <cstddef>
#include <vector>

#include "mesh/triangle_tree.hpp"

namespace pliant::mesh {

struct SharpEdges {
    std::vector<std::vector<Vec3>> chains;  ///< they meet at their ends only
    std::size_t dropped = 0;                ///< edges that were too near to others
};

/// Edges of two triangles that are sharper than `angle_deg` and bound material (by the winding number), in chains that
/// are broken where three or more meet and at sharp bends. Edges that cross another one, or come nearer to it than a
/// tenth of `size` without meeting it, are left out: a mesher that keeps them would never come to an end.
[[nodiscard]] SharpEdges sharp_edges(const TriangleTree& tree, double size, double angle_deg);

}  // namespace pliant::mesh
