// The triangles of a surface by their corners.
#pragma once

#include <array>
#include <cstddef>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

using Corners = std::array<Vec3, 3>;

/// The corners of a triangle of the surface.
[[nodiscard]] inline Corners corners(const TriMesh& surface, std::size_t triangle) {
    const auto& [a, b, c] = surface.triangles[triangle];
    const auto& p = surface.points;
    return {p[static_cast<std::size_t>(a)], p[static_cast<std::size_t>(b)], p[static_cast<std::size_t>(c)]};
}

/// Perpendicular to the triangle, as long as its area is large.
[[nodiscard]] inline Vec3 area_normal(const Corners& t) {
    return 0.5 * cross(t[1] - t[0], t[2] - t[0]);
}

/// The sum of the areas of all triangles.
[[nodiscard]] inline double surface_area(const TriMesh& surface) {
    double sum = 0;
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) sum += norm(area_normal(corners(surface, i)));
    return sum;
}

}  // namespace pliant::mesh
