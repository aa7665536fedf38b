// Decodes an input into bodies: boxes and tetrahedra on a coarse grid, so that they touch, overlap and nest; some
// corners are moved, so that faces bend and intersect; sometimes just random triangles.
#pragma once

#include "bytes.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace shapes {

using pliant::Vec3;
using pliant::mesh::TriMesh;

inline Vec3 grid_point(Bytes& bytes, int most) {
    const int x = bytes.up_to(most), y = bytes.up_to(most), z = bytes.up_to(most);
    return {double(x), double(y), double(z)};
}

inline TriMesh box(Bytes& bytes) {
    const Vec3 low = grid_point(bytes, 7), size = grid_point(bytes, 7) + Vec3{1, 1, 1};
    TriMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.points.push_back(low + Vec3{(i & 1) * size.x, (i >> 1 & 1) * size.y, (i >> 2) * size.z});
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

inline TriMesh tetrahedron(Bytes& bytes) {
    TriMesh mesh;
    for (int i = 0; i < 4; ++i) mesh.points.push_back(grid_point(bytes, 15));
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    return mesh;
}

/// A closed surface; it may intersect itself or have no volume.
inline TriMesh closed(Bytes& bytes) {
    TriMesh mesh = bytes.chance() ? tetrahedron(bytes) : box(bytes);
    for (int moved = bytes.up_to(3); moved > 0; --moved) {
        Vec3& p = mesh.points[static_cast<std::size_t>(bytes.up_to(static_cast<int>(mesh.points.size()) - 1))];
        p += Vec3{bytes.signed_byte() / 64.0, bytes.signed_byte() / 64.0, bytes.signed_byte() / 64.0};
    }
    return mesh;
}

inline TriMesh any(Bytes& bytes) {
    if (bytes.up_to(3) != 0) return closed(bytes);
    TriMesh mesh;
    const int points = 3 + bytes.up_to(9);
    for (int i = 0; i < points; ++i) mesh.points.push_back(grid_point(bytes, 15));
    for (int i = bytes.up_to(15); i >= 0; --i)
        mesh.triangles.push_back({bytes.up_to(points - 1), bytes.up_to(points - 1), bytes.up_to(points - 1)});
    return mesh;
}

}  // namespace shapes
