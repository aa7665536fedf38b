// Sharp edges of surfaces, for a mesher that needs them as input.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/meshing/labelled_space.hpp"

namespace pliant::mesh {

struct SharpEdges {
    std::vector<std::vector<Vec3>> chains;  ///< they meet only at their ends
    std::size_t dropped = 0;                ///< edges too near to others
};

/// Edges between two triangles of a surface that are sharper than `angle_deg` and lie where labels meet, as chains that
/// are split where three or more meet and at sharp bends. Edges common to several surfaces appear once. Edges that
/// cross another one, or come nearer to it than a tenth of `size` without meeting it, are left out (of edges of
/// different surfaces, that of the later one): a mesher that must keep them would not terminate.
[[nodiscard]] SharpEdges sharp_edges(const LabelledSpace& space, double size, double angle_deg);

}  // namespace pliant::mesh
