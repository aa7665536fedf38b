#include "geometry/meshing/walls.hpp"

#include "geometry/mesh/triangle_tree.hpp"

namespace pliant::mesh {

std::vector<WallSample> wall_samples(const TriMesh& surface) {
    constexpr double opposite = -0.9;  // cosine of the angle between the two faces' normals
    const TriangleTree tree(surface);
    std::vector<WallSample> samples;
    const auto corner = [&](int triangle, std::size_t k) {
        return surface.points[static_cast<std::size_t>(surface.triangles[static_cast<std::size_t>(triangle)][k])];
    };
    const auto normal = [&](int t) { return cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)); };
    for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
        const Vec3 outwards = normal(t);
        const double length = norm(outwards);
        if (!(length > 0)) continue;
        const Vec3 middle = (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3;
        const double edge = (norm(corner(t, 0) - corner(t, 1)) + norm(corner(t, 1) - corner(t, 2)) +
                             norm(corner(t, 2) - corner(t, 0))) /
                            3;
        const auto hit = tree.first_hit(middle, outwards / -length, 1e-6 * edge);
        if (!hit) continue;
        const Vec3 behind = normal(hit->triangle);
        if (dot(behind, outwards) < opposite * norm(behind) * length) samples.push_back({middle, hit->distance, edge});
    }
    return samples;
}

}  // namespace pliant::mesh
