// Detects self-intersections: given such a surface, volume meshers may not terminate.
#pragma once

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// True if an edge meets a triangle with which it shares no corner, or triangles overlap in their plane; touching
/// counts, within rounding. Cost: about n log n.
[[nodiscard]] bool cuts_itself(const TriMesh& surface);

/// The smallest height of its triangles as a fraction of the surface's size (the diagonal of its box).
[[nodiscard]] double finest_detail(const TriMesh& surface);

}  // namespace pliant::mesh
