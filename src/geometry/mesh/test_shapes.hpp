// Shapes for the tests of this module.
#pragma once

#include <memory>
#include <utility>

#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh::test {

/// A cube from `low`, 12 triangles.
inline TriMesh cube(const Vec3& low = {0, 0, 0}, double side = 10) {
    TriMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.points.push_back(low + side * Vec3{double(i & 1), double(i >> 1 & 1), double(i >> 2)});
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

/// The corner of a cube of side 1 at the origin: volume 1/6, outward normals.
inline TriMesh tetrahedron() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

inline TriMesh joined(TriMesh a, const TriMesh& b) {
    append(a, b);
    return a;
}

inline Solid solid(decltype(SolidNode::shape) shape) {
    return std::make_shared<const SolidNode>(SolidNode{std::move(shape)});
}

inline Solid box(Vec3 low, Vec3 high) {
    return solid(BoxSolid{low, high});
}

inline Solid without(Solid first, Solid second) {
    return solid(CombinedSolid{CombinedSolid::Operation::subtract, {std::move(first), std::move(second)}});
}

}  // namespace pliant::mesh::test
