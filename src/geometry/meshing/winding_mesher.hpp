// Meshes what surfaces mean, damaged, touching or cutting through each other: where one winds around a point more than
// half a time, there is its material.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/repair/surface_orientation.hpp"

namespace pliant::mesh {

/// A linear mesh in one region, of edges about `size` long, of a surface that may have holes, flipped, repeated and
/// flat triangles, edges of more than two triangles, and may cut through itself. Edges sharper than `angle_deg` stay
/// where the surface is whole around them, and where they keep a tenth of `size` from each other. Notes count the
/// damage. Errors: a surface that encloses nothing (an open sheet); a mesh that misses more than a tenth of the volume;
/// one of more than 20 million tets. The same input gives the same mesh. Through CGAL's Mesh_3.
[[nodiscard]] Result<TetMesh> mesh_by_winding(const TriMesh& surface, double size, double angle_deg,
                                              Progress& progress);

/// Wanted edge length in surface i at a point.
using SizeOfSurface = std::function<double(std::size_t, const Vec3&)>;

/// The same of several surfaces that may touch and overlap: region i is surface i, neighbours share the nodes of their
/// common face, and where surfaces overlap the last of them has it. `names`: what messages call each surface. `size`:
/// the largest that `size_at` gives.
struct JointMesh {
    TetMesh mesh;
    std::vector<SurfaceDamage> damage;  ///< of each surface
    /// A volume that two surfaces enclose, and which of them has it; by sampling, some thousandths of a body at least.
    struct Overlap {
        std::size_t loser, keeper;
        double volume;
    };
    std::vector<Overlap> overlaps;
};
[[nodiscard]] Result<JointMesh> mesh_together(std::span<const TriMesh> surfaces, std::span<const std::string> names,
                                              double size, const SizeOfSurface& size_at, double angle_deg,
                                              Progress& progress);

/// "3 open edges, 1 flat triangles"; empty where there is none.
[[nodiscard]] std::string describe(const SurfaceDamage& damage);

}  // namespace pliant::mesh
