// Meshes what a damaged surface means: where it winds around a point more than half a time, there is material.
#pragma once

#include "core/error.hpp"
#include "core/progress.hpp"
#include "mesh/tet_mesh.hpp"
#include "mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// A linear mesh in one region, of edges about `size` long, of a surface that may have holes, flipped, repeated and
/// flat triangles, edges of more than two triangles, and may cut through itself. Edges sharper than `angle_deg` stay
/// where the surface is whole around them, and where they keep a tenth of `size` from each other. Notes count the
/// damage. Errors: a surface that encloses nothing (an open sheet); a mesh that misses more than a tenth of the volume;
/// one of more than 20 million tets. The same input gives the same mesh. Through CGAL's Mesh_3.
[[nodiscard]] Result<TetMesh> mesh_by_winding(const TriMesh& surface, double size, double angle_deg,
                                              Progress& progress);

}  // namespace pliant::mesh
