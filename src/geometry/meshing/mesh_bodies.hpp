// Implements mesh_bodies() of mesher.hpp inside the worker process.
#pragma once

#include <span>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "geometry/mesher/mesher.hpp"

namespace pliant::mesh::kernel {

/// See mesher.hpp; `way`: in which solids are built first (build_solid.hpp).
[[nodiscard]] Result<TetMesh> mesh_bodies(std::span<const BodyGeometry> drawn, const MeshSettings& settings,
                                          Progress& progress, int way = 0);

}  // namespace pliant::mesh::kernel
