// Improves slivers of a mesh of drawn solids, linear or with curved edges.
#pragma once

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// improve_tets() for a mesh whose surface lies on drawn faces: nodes and triangles of curved faces are kept; flat
/// faces may be retriangulated. Mid-edge nodes of a quadratic mesh stay on the curves; those of new edges are
/// midpoints. No change if no dihedral angle is below `wanted_deg` (or above 180 minus it), or none can be improved.
void improve_drawn_tets(TetMesh& mesh, double wanted_deg);

}  // namespace pliant::mesh
