// The sharp edges of surfaces, for a mesher that must be told of them.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/meshing/labelled_space.hpp"

namespace pliant::mesh {

struct SharpEdges {
    std::vector<std::vector<Vec3>> chains;  ///< they meet at their ends only
    std::size_t dropped = 0;                ///< edges that were too near to others
};

/// Edges of two triangles of a surface that are sharper than `angle_deg` and lie where labels meet, in chains that are
/// broken where three or more meet and at sharp bends. What several surfaces have in common counts once. Edges that
/// cross another one, or come nearer to it than a tenth of `size` without meeting it, are left out (if the two are of
/// different surfaces, that of the later one): a mesher that keeps them would never come to an end.
[[nodiscard]] SharpEdges sharp_edges(const LabelledSpace& space, double size, double angle_deg);

}  // namespace pliant::mesh
