#include "geometry/mesh/placement.hpp"

#include <cstddef>
#include <utility>

#include "base/core/rotation.hpp"

namespace pliant::mesh {
namespace {

bool mirrors(const Placement& placement) {
    return norm(placement.mirror_normal) > 0;
}

/// The points of all copies, one after the other.
std::vector<Vec3> placed_points(std::vector<Vec3> points, const Placement& placement) {
    for (Vec3& p : points) p = place(p, placement);
    const std::size_t one = points.size();
    points.reserve(one * static_cast<std::size_t>(placement.count));
    for (std::size_t k = one; k < one * static_cast<std::size_t>(placement.count); ++k)
        points.push_back(moved(points[k - one], placement.step));
    return points;
}

}  // namespace

Vec3 moved(const Vec3& point, const RigidMotion& motion) {
    if (motion.angle_rad == 0) return point + motion.shift;
    return motion.center + turned(point - motion.center, unit(motion.axis), motion.angle_rad) + motion.shift;
}

Vec3 place(const Vec3& point, const Placement& placement) {
    Vec3 p = placement.scale * point;
    if (mirrors(placement)) {
        const Vec3 n = unit(placement.mirror_normal);
        p = p - 2 * dot(n, p - placement.mirror_point) * n;
    }
    return moved(p, placement.motion);
}

TriMesh placed(TriMesh mesh, const Placement& placement) {
    const int points = static_cast<int>(mesh.points.size());
    mesh.points = placed_points(std::move(mesh.points), placement);
    if (mirrors(placement)) {
        for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    }
    const std::size_t one = mesh.triangles.size();
    for (std::size_t k = one; k < one * static_cast<std::size_t>(placement.count); ++k) {
        const auto [a, b, c] = mesh.triangles[k - one];
        mesh.triangles.push_back({a + points, b + points, c + points});
    }
    return mesh;
}

TetMesh placed(TetMesh mesh, const Placement& placement) {
    const int points = static_cast<int>(mesh.points.size());
    mesh.points = placed_points(std::move(mesh.points), placement);
    const auto width = static_cast<std::size_t>(mesh.nodes_per_tet());
    for (std::size_t t = 0; mirrors(placement) && t < mesh.tet_count(); ++t)
        reverse_tet({mesh.nodes.data() + width * t, width});
    const std::size_t nodes = mesh.nodes.size(), tets = mesh.region.size();
    for (int copy = 1; copy < placement.count; ++copy) {
        for (std::size_t k = 0; k < nodes; ++k) mesh.nodes.push_back(mesh.nodes[k] + copy * points);
        for (std::size_t t = 0; t < tets; ++t) mesh.region.push_back(mesh.region[t]);
    }
    return mesh;
}

}  // namespace pliant::mesh
