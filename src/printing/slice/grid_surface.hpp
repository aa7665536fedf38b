// A triangle surface on an integer grid: equal points have equal bits, and all comparisons are exact.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::slice {

/// 1/1024 um, about one nanometre: far below a pixel, while 2 m still fits 32 bits.
inline constexpr int grid_per_um = 1024;
inline constexpr double max_coordinate_um = 2e6;

struct GridPoint {
    std::int32_t x = 0, y = 0, z = 0;
    bool operator==(const GridPoint&) const = default;
    // clang-tidy 14 mistakes the 0 in comparisons derived from this one for a null pointer.
    auto operator<=>(const GridPoint&) const = default;  // NOLINT(modernize-use-nullptr)
};

using Triangle = std::array<int, 3>;

struct GridSurface {
    std::vector<GridPoint> points;    ///< (n), all different
    std::vector<Triangle> triangles;  ///< (m), three different corners each
};

/// Snaps to the grid, merges points that coincide, and drops what becomes degenerate: triangles with two equal corners
/// and exact duplicates. Errors (prefixed with `label`): a coordinate that is not finite or beyond 2 m, a missing
/// corner.
[[nodiscard]] Result<GridSurface> snap_to_grid(const mesh::TriMesh& surface_um, std::string_view label);

/// Merges points at open edges that are at most `reach_um` apart, as mesh::close_seams() does, and drops what becomes
/// degenerate. Returns the number of points merged into another.
std::size_t join_near_points(GridSurface& surface, double reach_um);

/// Six times the signed volume of the tetrahedron with the grid's origin, in grid units cubed.
[[nodiscard]] double signed_volume6(const GridSurface& surface, const Triangle& triangle);

/// Twice the area vector of a triangle, in grid units squared.
[[nodiscard]] Vec3 area_vector2(const GridSurface& surface, const Triangle& triangle);

/// Enclosed volume of a closed surface, negative if it is inside out.
[[nodiscard]] double volume_mm3(const GridSurface& surface);
[[nodiscard]] double area_mm2(const GridSurface& surface);

inline constexpr double mm2_per_grid2 = 1e-6 / (1.0 * grid_per_um * grid_per_um);

}  // namespace pliant::slice
