// Places a mesh from a file: scaled, mirrored, rotated, translated and repeated.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "base/core/vec3.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// A rotation, right-handed about an axis through a point, followed by a translation. Lengths are in the mesh's unit.
struct RigidMotion {
    double angle_rad = 0;
    Vec3 axis{0, 0, 1};  ///< of any non-zero length
    Vec3 center;
    Vec3 shift;
};

/// Scaling about the origin, then mirroring, then the motion; then copies, each moved by `step` from the previous one.
struct Placement {
    double scale = 1;    ///< positive
    Vec3 mirror_normal;  ///< normal of the mirror plane; zero: no mirror
    Vec3 mirror_point;   ///< a point of the mirror plane
    RigidMotion motion;
    int count = 1;  ///< total number of copies
    RigidMotion step;
};

/// The position of a point in the first copy.
[[nodiscard]] Vec3 place(const Vec3& point, const Placement& placement);
/// The position in a copy of what is at `point` in the previous copy.
[[nodiscard]] Vec3 moved(const Vec3& point, const RigidMotion& motion);

/// Mirrored triangles and tets keep their orientation, outward and positive. Copies share no nodes; a copied tet has
/// the region of its original.
[[nodiscard]] TriMesh placed(TriMesh mesh, const Placement& placement);
[[nodiscard]] TetMesh placed(TetMesh mesh, const Placement& placement);

}  // namespace pliant::mesh
