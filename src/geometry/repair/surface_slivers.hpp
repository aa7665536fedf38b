// Flat triangles, as CAD programs leave them where an edge has a point in its middle. They do not affect the shape, and
// no mesher accepts them.
#pragma once

#include <cstddef>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// A triangle is flat if its smallest height is below this fraction of its longest edge: the height that rounding to
/// 32-bit coordinates can give a degenerate triangle, far below the resolution of a mesh or a printer.
inline constexpr double flat_triangle = 1e-4;

[[nodiscard]] bool has_flat_triangles(const TriMesh& surface);

struct SliverCount {
    std::size_t removed = 0;
    std::size_t left = 0;  ///< flat triangles that could not be removed without changing the shape
};

/// Removes triangles with two equal corners, and flips the longest edge of flat ones, which moves the surface by no
/// more than their height. A surface that is closed (check_closed(), ignoring triangles with equal corners) stays
/// closed.
[[nodiscard]] SliverCount remove_slivers(TriMesh& surface);

}  // namespace pliant::mesh
