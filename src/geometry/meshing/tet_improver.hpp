// Improves slivers of a tet mesh locally.
#pragma once

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

struct ImproveSettings {
    double wanted_deg = 7;    ///< tets with a dihedral angle below this, or above 180 minus it, are improved
    double feature_deg = 30;  ///< the surface normal may change by less than this: sharper edges are preserved
};

/// Works on slivers and their neighbours and leaves the rest of the mesh unchanged: nodes are moved and merged, edges
/// swapped, as long as the worst tet nearby improves (by the smallest sine of its dihedral angles). Nodes inside a
/// region move freely, those on flat faces in their plane, those on straight edges along them. Where the surface is
/// curved, but by less than `feature_deg` between neighbours, nodes slide over its triangles and its edges are swapped;
/// that moves the surface by no more than its discretisation error. Nodes without a tet are removed; apart from the
/// sliding, regions keep their volumes. Deterministic. Precondition: linear tets, positively oriented.
void improve_tets(TetMesh& mesh, const ImproveSettings& settings);

}  // namespace pliant::mesh
