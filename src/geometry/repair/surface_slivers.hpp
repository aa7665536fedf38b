// Triangles without area, as drawing programs leave them where an edge has a point in its middle. They mean nothing for
// the shape, and no mesher takes them.
#pragma once

#include <cstddef>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// A triangle is flat if its smallest height is below this part of its longest edge: what 32-bit coordinates make of a
/// triangle without any height, and far below what a mesh or a printer resolves.
inline constexpr double flat_triangle = 1e-4;

[[nodiscard]] bool has_flat_triangles(const TriMesh& surface);

struct SliverCount {
    std::size_t removed = 0;
    std::size_t left = 0;  ///< flat triangles that could not be removed without a change of shape
};

/// Removes triangles with two equal corners, and flips the longest edge of flat ones, which moves the surface by no
/// more than their height. A closed surface, as of check_closed() but for triangles with equal corners, stays closed.
[[nodiscard]] SliverCount remove_slivers(TriMesh& surface);

}  // namespace pliant::mesh
