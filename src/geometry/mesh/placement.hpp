// Puts a mesh from a file where it belongs: scaled, mirrored, rotated, moved, and repeated.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "base/core/vec3.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// A rotation, right-handed about an axis through a point, and then a shift. Lengths are in the mesh's unit.
struct RigidMotion {
    double angle_rad = 0;
    Vec3 axis{0, 0, 1};  ///< of any length but zero
    Vec3 center;
    Vec3 shift;
};

/// First the scale, about the origin, then the mirror, then the motion; then copies, each moved by `step` from the one
/// before it.
struct Placement {
    double scale = 1;    ///< above zero
    Vec3 mirror_normal;  ///< of the mirror's plane; zero: none
    Vec3 mirror_point;   ///< of the mirror's plane
    RigidMotion motion;
    int count = 1;  ///< how many there are in the end
    RigidMotion step;
};

/// Where the first copy of a point is.
[[nodiscard]] Vec3 place(const Vec3& point, const Placement& placement);
/// Where a copy is put that lay at `point` in the copy before it.
[[nodiscard]] Vec3 moved(const Vec3& point, const RigidMotion& motion);

/// Triangles and tets keep their orientation, outward and positive, where they are mirrored. Copies share no nodes; a
/// tet of a copy has the region of the tet that it was made from.
[[nodiscard]] TriMesh placed(TriMesh mesh, const Placement& placement);
[[nodiscard]] TetMesh placed(TetMesh mesh, const Placement& placement);

}  // namespace pliant::mesh
