// Bodies that nearly touch: drawn to stand on each other, but a rounded number apart.
#pragma once

#include <vector>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// Empty space between two regions, where both are not joined. Lengths in the mesh's unit.
struct NarrowGap {
    int first, second;  ///< regions, the lower one first
    double width;       ///< the largest found, not above the tolerance
    Vec3 at;            ///< a point of it, where it is that wide
};

/// The gaps of at most `tolerance` (above zero) between regions, one for each two regions, in their order. Where a
/// whole face of one is that near to the other there is a gap; on round bodies its width is that between chords.
[[nodiscard]] std::vector<NarrowGap> narrow_gaps(const TetMesh& mesh, double tolerance);

}  // namespace pliant::mesh
