#include "simulation/contact/obstacle_inset.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/repair/surface_check.hpp"

namespace pliant::sim::contact {

namespace {

Vec3 normal_of(const std::vector<Vec3>& points, const std::array<int, 3>& t) {
    const Vec3 n = cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]);
    const double length = norm(n);
    return length > 0 ? n / length : Vec3{};
}

double angle_at(const std::vector<Vec3>& points, const std::array<int, 3>& t, std::size_t k) {
    const Vec3 u = points[t[(k + 1) % 3]] - points[t[k]], v = points[t[(k + 2) % 3]] - points[t[k]];
    return std::atan2(norm(cross(u, v)), dot(u, v));
}

}  // namespace

std::optional<std::vector<Vec3>> inset(const mesh::TriMesh& surface, double depth) {
    if (!mesh::check_closed(surface)) return std::nullopt;
    const double volume = mesh::signed_volume(surface);
    const auto& points = surface.points;
    // Mean normals, weighted by the face angles at each point, so that they do not depend on the triangulation.
    std::vector<Vec3> mean(points.size());
    std::vector<double> angle(points.size()), along(points.size());
    for (const auto& t : surface.triangles)
        for (std::size_t k = 0; k < 3; ++k) mean[t[k]] += angle_at(points, t, k) * normal_of(points, t);
    for (Vec3& n : mean) n = norm(n) > 0 ? n / norm(n) : n;
    for (const auto& t : surface.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const double a = angle_at(points, t, k);
            angle[t[k]] += a;
            along[t[k]] += a * dot(mean[t[k]], normal_of(points, t));
        }
    constexpr double sharpest = 0.3;  // sharper corners are cut off rather than moved far inwards
    mesh::TriMesh smaller = surface;
    for (std::size_t p = 0; p < points.size(); ++p)
        if (angle[p] > 0) smaller.points[p] -= depth / std::max(along[p] / angle[p], sharpest) * mean[p];
    for (const auto& t : surface.triangles)
        if (dot(normal_of(points, t), normal_of(smaller.points, t)) < 0) return std::nullopt;
    const double left = mesh::signed_volume(smaller) / volume;
    if (!(left > 0 && left < 1)) return std::nullopt;
    return std::move(smaller.points);
}

}  // namespace pliant::sim::contact
