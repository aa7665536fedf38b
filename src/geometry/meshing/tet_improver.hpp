// Slivers of a tet mesh made better where they are.
#pragma once

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

struct ImproveSettings {
    double wanted_deg = 7;    ///< tets with a dihedral angle below this, or above 180 less this, are worked on
    double feature_deg = 30;  ///< the surface may be turned by less than this: sharper edges stay
};

/// Works on slivers and their neighbours, the rest of the mesh stays: nodes are moved and joined, edges swapped, as
/// long as the worst tet around becomes better (by the smallest sine of its dihedral angles). Nodes inside a region
/// move freely; those on flat faces in their plane, those on straight edges along them. Where the surface is curved,
/// but by less than `feature_deg` between neighbours, nodes slide over its triangles and its edges are swapped; that
/// moves the surface by no more than the mesh differs from it anyway. Nodes without a tet are left out; regions keep
/// their volumes but for that. The same mesh gives the same result. Precondition: linear tets, positively oriented.
void improve_tets(TetMesh& mesh, const ImproveSettings& settings);

}  // namespace pliant::mesh
