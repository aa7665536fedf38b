// Gaps between bodies that were meant to touch but are a rounding error apart.
#pragma once

#include <vector>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// Empty space between two regions that are not joined there. Lengths in the mesh's unit.
struct NarrowGap {
    int first, second;  ///< regions, the lower one first
    double width;       ///< the largest found, at most the tolerance
    Vec3 at;            ///< a point of the gap where it is that wide
};

/// The gaps of at most `tolerance` (above zero) between regions, one per pair of regions, in their order. A gap counts
/// only if a whole face of one region is that near to the other; on round bodies its width is measured between chords.
[[nodiscard]] std::vector<NarrowGap> narrow_gaps(const TetMesh& mesh, double tolerance);

}  // namespace pliant::mesh
