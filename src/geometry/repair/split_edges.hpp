// Finer triangles on the same surface.
#pragma once

#include <functional>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// The same surface, closed if it was, with edges split in the middle until each is at most `longest(its middle)`;
/// points are kept and others added after them. No more splits above `most` triangles.
[[nodiscard]] TriMesh with_short_edges(TriMesh surface, const std::function<double(const Vec3&)>& longest,
                                       std::size_t most = 1000000);

}  // namespace pliant::mesh
