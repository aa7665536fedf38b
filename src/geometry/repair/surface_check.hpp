// Is a surface fit to enclose a volume?
#pragma once

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// Every edge has exactly one neighbour that runs the other way, and the volume is positive. The error counts what is
/// open or says that the surface is inside out.
[[nodiscard]] Status check_closed(const TriMesh& surface);

}  // namespace pliant::mesh
