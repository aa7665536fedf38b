// Closed cavities of a mesh (the air inside): the one at a point, and the surface without any.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// The faces of the outer surface that bound the empty space around a point, those of bodies that float in it included,
/// normals pointing into it, in the order of boundary_faces(). Errors: the point lies in the material, or the space
/// around it is open to the outside. Cost: all faces.
[[nodiscard]] Result<std::vector<Face>> cavity_faces(const TetMesh& mesh, const Vec3& point);

/// The boundary_faces() that can be reached from outside: without those that bound closed cavities, and without bodies
/// that float in one. Cost: all faces.
[[nodiscard]] std::vector<Face> faces_from_outside(const TetMesh& mesh);

}  // namespace pliant::mesh
