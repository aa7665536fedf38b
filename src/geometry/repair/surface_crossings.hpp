// Does a surface cut through itself? Meshers of the volume inside it may not come back from one that does.
#pragma once

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// True if an edge meets a triangle that it has no corner in common with, or triangles lie upon each other; touching
/// counts, within rounding. Cost: about n log n.
[[nodiscard]] bool cuts_itself(const TriMesh& surface);

/// The smallest height of its triangles as a share of the surface's size (the diagonal of its box).
[[nodiscard]] double finest_detail(const TriMesh& surface);

}  // namespace pliant::mesh
