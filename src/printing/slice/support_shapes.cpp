#include "printing/slice/support_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pliant::slice {
namespace {

constexpr int sides = 16;
using Point = std::array<double, 2>;

/// Positive if c is to the left of the direction from a to b.
double left_turn(const Point& a, const Point& b, const Point& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Counter-clockwise, by Andrew's monotone chain.
std::vector<Point> convex_hull(std::vector<Point> points) {
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    std::vector<Point> hull;
    const auto half = [&](auto begin, auto end) {
        const std::size_t kept = hull.size() + 1;
        for (auto p = begin; p != end; ++p) {
            while (hull.size() > kept && left_turn(hull[hull.size() - 2], hull.back(), *p) <= 0) hull.pop_back();
            hull.push_back(*p);
        }
        hull.pop_back();
    };
    half(points.begin(), points.end());
    half(points.rbegin(), points.rend());
    return hull;
}

/// A horizontal polygon with the area of a circle.
std::vector<Vec3> circle(const Vec3& centre, double radius_um) {
    constexpr double angle = 2 * std::numbers::pi / sides;
    const double equal_area = std::sqrt(angle / std::sin(angle)) * radius_um;
    std::vector<Vec3> around;
    around.reserve(sides);
    for (int i = 0; i < sides; ++i)
        around.push_back(centre + equal_area * Vec3{std::cos(i * angle), std::sin(i * angle), 0});
    return around;
}

/// Walls between rings of `n` points, closed by a fan at both ends.
mesh::TriMesh closed_tube(const std::vector<std::vector<Vec3>>& rings) {
    mesh::TriMesh mesh;
    const int n = static_cast<int>(rings[0].size());
    for (const auto& ring : rings) mesh.points.insert(mesh.points.end(), ring.begin(), ring.end());
    for (int r = 0; r + 1 < static_cast<int>(rings.size()); ++r) {
        for (int i = 0; i < n; ++i) {
            const int a = r * n + i, b = r * n + (i + 1) % n;
            mesh.triangles.push_back({a, b, b + n});
            mesh.triangles.push_back({a, b + n, a + n});
        }
    }
    const int last = (static_cast<int>(rings.size()) - 1) * n;
    for (int i = 1; i + 1 < n; ++i) {
        mesh.triangles.push_back({0, i + 1, i});
        mesh.triangles.push_back({last, last + i, last + i + 1});
    }
    return mesh;
}

}  // namespace

mesh::TriMesh turned_solid(double x_um, double y_um, const std::vector<Ring>& rings) {
    std::vector<std::vector<Vec3>> points;
    points.reserve(rings.size());
    for (const Ring& ring : rings) points.push_back(circle({x_um, y_um, ring.z_um}, ring.radius_um));
    return closed_tube(points);
}

mesh::TriMesh rod(const Vec3& from_um, const Vec3& to_um, double radius_um) {
    return closed_tube({circle(from_um, radius_um), circle(to_um, radius_um)});
}

mesh::TriMesh hull_prism(const std::vector<std::array<double, 2>>& points_um, double margin_um, double bottom_um,
                         double top_um) {
    std::vector<Point> around;
    for (const auto& [x, y] : points_um) {
        for (int i = 0; i < sides; ++i) {
            const double angle = 2 * std::numbers::pi * i / sides;
            around.push_back({x + margin_um * std::cos(angle), y + margin_um * std::sin(angle)});
        }
    }
    std::vector<std::vector<Vec3>> rings(2);
    for (const Point& p : convex_hull(std::move(around))) {
        rings[0].push_back({p[0], p[1], bottom_um});
        rings[1].push_back({p[0], p[1], top_um});
    }
    return closed_tube(rings);
}

}  // namespace pliant::slice
