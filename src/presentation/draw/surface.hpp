// The outer skin of the solid regions, for drawing: vertices are split along sharp edges, so that a box has flat faces
// and a bent finger a smooth back. Built once at rest; a pose moves it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/core/vec3.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::report {

struct Surface {
    std::vector<int> vertex_node;               ///< (v), the mesh node that each vertex sits on
    std::vector<std::array<int, 3>> triangles;  ///< (t), indices of vertices, counter-clockwise from outside
    std::vector<int> material;                  ///< (t)
    std::vector<int> tet;                       ///< (t), the tet behind the triangle
};

/// Faces between solid tets and everything else (outside and voids); each face of a quadratic tet gives four triangles.
/// `region_material` (regions): -1 for voids. Two triangles of one material share a
/// vertex unless their angle at rest is over 35 degrees.
[[nodiscard]] Surface outer_surface(const mesh::TetMesh& mesh, std::span<const int> region_material);

/// The same for a rigid body: its points are the nodes, its material is 0, and there are no tets behind it (-1).
[[nodiscard]] Surface rigid_surface(const mesh::TriMesh& mesh);

struct Pose {
    std::vector<Vec3> positions;  ///< (v)
    std::vector<Vec3> normals;    ///< (v), unit, area-weighted mean of the triangles around
};

[[nodiscard]] Pose pose(const Surface& surface, std::span<const Vec3> node_positions);

/// Converts values per tet to values per vertex: the mean over the solid tets of the vertex's material at its node,
/// weighted by rest volume (stress jumps between materials, so they are never averaged across).
[[nodiscard]] std::vector<double> at_vertices(const mesh::TetMesh& mesh, std::span<const int> region_material,
                                              const Surface& surface, std::span<const double> tet_values);

}  // namespace pliant::report
