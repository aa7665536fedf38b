// Slivers of a mesh that follows drawn solids, linear or with curved edges.
#pragma once

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// improve_tets() for a mesh whose surface lies on drawn faces: a face that is curved stays as it is, node by node,
/// flat ones may be divided anew. The mid-edge nodes of a quadratic mesh stay on the curves; those of new edges lie in
/// the middle. Nothing changes where no dihedral angle is below `wanted_deg` (or above 180 less this), or none gets
/// better.
void improve_drawn_tets(TetMesh& mesh, double wanted_deg);

}  // namespace pliant::mesh
