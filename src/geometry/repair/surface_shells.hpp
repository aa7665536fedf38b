// The closed shells of a surface: outer ones, and the cavities inside them.
#pragma once

#include <cstddef>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// Solid pieces of a closed surface (precondition: check_closed()): each result is one outer shell with the cavities
/// inside it, points compacted; in the order of the outer shells' first triangles. Errors: a cavity outside every outer
/// shell, an outer shell inside the material of another, more than 1000 shells. Does not detect shells that cross each
/// other.
[[nodiscard]] Result<std::vector<TriMesh>> solid_pieces(const TriMesh& surface);

/// The triangles of each shell (connected by edges), shells in the order of their first triangle.
[[nodiscard]] std::vector<std::vector<std::size_t>> shell_triangles(const TriMesh& surface);

/// The given triangles of a surface, in this order, with the points they use.
[[nodiscard]] TriMesh part_of(const TriMesh& surface, const std::vector<std::size_t>& triangles);

/// How many times a closed surface winds around a point off the surface: 1 inside, 0 outside (sum of solid angles / 4
/// pi; van Oosterom and Strackee 1983). Cost: all triangles.
[[nodiscard]] double winding_number(const TriMesh& surface, const Vec3& point);

/// The same surface with at least this many triangles in each shell: those of smaller shells are split at the midpoints
/// of their edges, repeatedly if needed.
[[nodiscard]] TriMesh with_enough_triangles(TriMesh surface, std::size_t least);

}  // namespace pliant::mesh
