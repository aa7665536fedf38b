#include "geometry/shapes/rod_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/shapes/single_shape.hpp"

namespace pliant::mesh {
namespace {

/// Two unit vectors across an axis, the second a quarter turn from the first.
std::pair<Vec3, Vec3> across(const Vec3& axis) {
    const Vec3 along = unit(axis);
    const Vec3 least = std::fabs(along.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 u = unit(cross(along, least));
    return {u, cross(along, u)};
}

int sides_for(double radius, double tolerance) {
    constexpr double least = 24, most = 2000;
    constexpr double nearer = 4.5;  // as the mesher makes small surfaces: many lengths and forces follow from them
    const double half_angle = std::acos(std::max(-1.0, 1 - tolerance / nearer / radius));
    return static_cast<int>(std::clamp(std::ceil(std::numbers::pi / half_angle), least, most));
}

}  // namespace

std::optional<TriMesh> rod_surface(const Solid& solid, double tolerance) {
    const std::optional<CylinderSolid> rod = single_cylinder(solid);
    if (!rod) return std::nullopt;
    const int n = sides_for(rod->radius, tolerance);
    const auto [u, v] = across(rod->to - rod->from);
    TriMesh surface;
    for (const Vec3& centre : {rod->from, rod->to}) {
        surface.points.push_back(centre);
        for (int i = 0; i < n; ++i) {
            const double angle = 2 * std::numbers::pi * i / n;
            surface.points.push_back(centre + rod->radius * (std::cos(angle) * u + std::sin(angle) * v));
        }
    }
    const int top = n + 1;  // its centre; that of the other end is 0
    for (int i = 0; i < n; ++i) {
        const int a = 1 + i, b = 1 + (i + 1) % n;
        surface.triangles.push_back({0, b, a});
        surface.triangles.push_back({a, b, top + b});
        surface.triangles.push_back({a, top + b, top + a});
        surface.triangles.push_back({top, top + a, top + b});
    }
    return surface;
}

}  // namespace pliant::mesh
