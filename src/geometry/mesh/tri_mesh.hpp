// Triangle surfaces.
#pragma once

#include <array>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::mesh {

/// A triangle soup with shared points. Outward normals follow the right-hand rule where the surface is closed.
/// The unit of length is the caller's; every function says which one it expects.
struct TriMesh {
    std::vector<Vec3> points;                   ///< (n, 3)
    std::vector<std::array<int, 3>> triangles;  ///< (m, 3), indices into points
};

/// Sum of signed tetrahedra to the origin; the enclosed volume if the surface is closed and oriented outwards.
[[nodiscard]] double signed_volume(const TriMesh& mesh);

[[nodiscard]] Box3 bounds(const TriMesh& mesh);

/// Every point multiplied by `factor` (a change of unit).
[[nodiscard]] TriMesh scaled(TriMesh mesh, double factor);

/// Puts `other` beside what there is.
void append(TriMesh& surface, const TriMesh& other);

}  // namespace pliant::mesh
