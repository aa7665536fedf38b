// Triangle surfaces.
#pragma once

#include <array>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::mesh {

/// A triangle soup with shared points. Normals point outwards by the right-hand rule if the surface is closed.
/// The unit of length is the caller's; every function says which one it expects.
struct TriMesh {
    std::vector<Vec3> points;                   ///< (n, 3)
    std::vector<std::array<int, 3>> triangles;  ///< (m, 3), indices into points
};

/// Sum of signed volumes of tetrahedra with the origin; the enclosed volume if the surface is closed and oriented
/// outwards.
[[nodiscard]] double signed_volume(const TriMesh& mesh);

[[nodiscard]] Box3 bounds(const TriMesh& mesh);

/// Multiplies every point by `factor` (a change of unit).
[[nodiscard]] TriMesh scaled(TriMesh mesh, double factor);

/// Adds `other` to the surface, without merging points.
void append(TriMesh& surface, const TriMesh& other);

}  // namespace pliant::mesh
