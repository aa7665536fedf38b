// Solids for tests: as a triangle soup without shared points, as in an STL file.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/mesh/tri_mesh.hpp"
#include "printing/slice/body.hpp"

namespace pliant::slice::test {

/// Most of these solids fit into it: 6.4 x 4.8 mm.
inline const Raster small_raster{64, 48, 100};

inline void add_triangle(mesh::TriMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c) {
    const int first = static_cast<int>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), {a, b, c});
    mesh.triangles.push_back({first, first + 1, first + 2});
}

struct Point2 {
    double x, y;
};

/// An upright prism over a convex counter-clockwise outline.
inline mesh::TriMesh prism(const std::vector<Point2>& outline, double z0, double z1) {
    mesh::TriMesh mesh;
    const std::size_t n = outline.size();
    const auto at = [&](std::size_t i, double z) { return Vec3{outline[i % n].x, outline[i % n].y, z}; };
    for (std::size_t i = 1; i + 1 < n; ++i) {
        add_triangle(mesh, at(0, z0), at(i + 1, z0), at(i, z0));
        add_triangle(mesh, at(0, z1), at(i, z1), at(i + 1, z1));
    }
    for (std::size_t i = 0; i < n; ++i) {
        add_triangle(mesh, at(i, z0), at(i + 1, z0), at(i + 1, z1));
        add_triangle(mesh, at(i, z0), at(i + 1, z1), at(i, z1));
    }
    return mesh;
}

inline mesh::TriMesh box(const Vec3& low, const Vec3& high) {
    return prism({{low.x, low.y}, {high.x, low.y}, {high.x, high.y}, {low.x, high.y}}, low.z, high.z);
}

inline std::vector<Point2> regular_polygon(int corners, double radius, double turn = 0) {
    std::vector<Point2> outline;
    for (int i = 0; i < corners; ++i) {
        const double angle = turn + 2 * std::numbers::pi * i / corners;
        outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    return outline;
}

inline mesh::TriMesh turned_inside_out(mesh::TriMesh mesh) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

inline mesh::TriMesh together(mesh::TriMesh a, const mesh::TriMesh& b) {
    append(a, b);
    return a;
}

}  // namespace pliant::slice::test
