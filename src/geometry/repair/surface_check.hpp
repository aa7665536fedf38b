// Checks that a surface can enclose a volume.
#pragma once

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// Every edge has exactly one oppositely oriented neighbour, and the volume is positive. The error counts the open
/// edges or says that the surface is inside out.
[[nodiscard]] Status check_closed(const TriMesh& surface);

}  // namespace pliant::mesh
