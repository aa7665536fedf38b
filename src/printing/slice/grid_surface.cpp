#include "printing/slice/grid_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/repair/surface_seams.hpp"

namespace pliant::slice {
namespace {

Vec3 vector_of(const GridPoint& p) {
    return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}

std::int32_t snap(double um) {
    return static_cast<std::int32_t>(std::llround(um * grid_per_um));
}

Status check_points(const mesh::TriMesh& surface, std::string_view label) {
    for (std::size_t i = 0; i < surface.points.size(); ++i) {
        const Vec3& p = surface.points[i];
        if (!is_finite(p)) return input_error("{}: point {} is not finite ({}, {}, {})", label, i, p.x, p.y, p.z);
        if (std::fmax(std::fabs(p.x), std::fmax(std::fabs(p.y), std::fabs(p.z))) > max_coordinate_um)
            return input_error("{}: point {} lies at ({}, {}, {}) um, more than 2 m from the platform's centre", label,
                               i, p.x, p.y, p.z);
    }
    const int count = static_cast<int>(surface.points.size());
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        for (const int corner : surface.triangles[t]) {
            if (corner < 0 || corner >= count)
                return input_error("{}: triangle {} names point {}, there are {}", label, t, corner, count);
        }
    }
    return {};
}

/// Fills `surface.points` with the distinct points and returns the new index of each old one.
std::vector<int> weld(const std::vector<GridPoint>& points, GridSurface& surface) {
    std::vector<int> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    // Sorted by height, so that the data of one layer are close together.
    std::sort(order.begin(), order.end(), [&](int a, int b) {
        if (points[a].z != points[b].z) return points[a].z < points[b].z;
        return points[a] != points[b] ? points[a] < points[b] : a < b;
    });
    std::vector<int> index(points.size());
    for (const int i : order) {
        if (surface.points.empty() || surface.points.back() != points[i]) surface.points.push_back(points[i]);
        index[i] = static_cast<int>(surface.points.size()) - 1;
    }
    return index;
}

void drop_repetitions(std::vector<Triangle>& triangles) {
    // The smallest corner first: triangles with the same corners and orientation become identical.
    for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
}

}  // namespace

Result<GridSurface> snap_to_grid(const mesh::TriMesh& surface_um, std::string_view label) {
    if (auto status = check_points(surface_um, label); !status) return tl::unexpected(status.error());
    std::vector<GridPoint> snapped;
    snapped.reserve(surface_um.points.size());
    for (const Vec3& p : surface_um.points) snapped.push_back({snap(p.x), snap(p.y), snap(p.z)});
    GridSurface surface;
    const std::vector<int> index = weld(snapped, surface);
    surface.triangles.reserve(surface_um.triangles.size());
    for (const auto& [a, b, c] : surface_um.triangles) {
        const Triangle t{index[a], index[b], index[c]};
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) surface.triangles.push_back(t);
    }
    drop_repetitions(surface.triangles);
    return surface;
}

/// 32-bit integers are exact in double precision, and the order of the points is unchanged.
std::size_t join_near_points(GridSurface& surface, double reach_um) {
    mesh::TriMesh mesh{{}, surface.triangles};
    for (const GridPoint& p : surface.points) mesh.points.push_back(vector_of(p));
    const mesh::ClosedSeams closed = mesh::close_seams(mesh, reach_um * grid_per_um);
    if (closed.edges == 0) return 0;
    surface.points.clear();
    for (const Vec3& p : mesh.points)
        surface.points.push_back(
            {static_cast<std::int32_t>(p.x), static_cast<std::int32_t>(p.y), static_cast<std::int32_t>(p.z)});
    surface.triangles = std::move(mesh.triangles);
    drop_repetitions(surface.triangles);
    return closed.points;
}

double signed_volume6(const GridSurface& surface, const Triangle& t) {
    return dot(vector_of(surface.points[t[0]]),
               cross(vector_of(surface.points[t[1]]), vector_of(surface.points[t[2]])));
}

Vec3 area_vector2(const GridSurface& surface, const Triangle& t) {
    const Vec3 a = vector_of(surface.points[t[0]]);
    return cross(vector_of(surface.points[t[1]]) - a, vector_of(surface.points[t[2]]) - a);
}

double volume_mm3(const GridSurface& surface) {
    double volume6 = 0;
    for (const Triangle& t : surface.triangles) volume6 += signed_volume6(surface, t);
    return volume6 / 6 * mm2_per_grid2 * 1e-3 / grid_per_um;
}

double area_mm2(const GridSurface& surface) {
    double area2 = 0;
    for (const Triangle& t : surface.triangles) area2 += norm(area_vector2(surface, t));
    return area2 / 2 * mm2_per_grid2;
}

}  // namespace pliant::slice
