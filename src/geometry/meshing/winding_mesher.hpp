// Meshes surfaces that are damaged, touching or intersecting: a point is in the material if the winding number there is
// above one half.
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
/// flat triangles, edges of more than two triangles, and self-intersections. Edges sharper than `angle_deg` are kept
/// where the surface around them is intact and they are at least a tenth of `size` apart. Notes count the damage.
/// Errors: a surface that encloses nothing (an open sheet); a mesh that misses more than a tenth of the volume; one of
/// more than 20 million tets. The same input gives the same mesh. Uses CGAL's Mesh_3.
[[nodiscard]] Result<TetMesh> mesh_by_winding(const TriMesh& surface, double size, double angle_deg,
                                              Progress& progress);

/// Target edge length in surface i at a point.
using SizeOfSurface = std::function<double(std::size_t, const Vec3&)>;

/// The same for several surfaces that may touch and overlap: region i is surface i, neighbours share the nodes of their
/// common face, and an overlap belongs to the last of them. `names`: for messages. `size`: the maximum of `size_at`.
struct JointMesh {
    TetMesh mesh;
    std::vector<SurfaceDamage> damage;  ///< one per surface
    /// A volume that two surfaces enclose, and which of them gets it; estimated by sampling, at least some thousandths
    /// of a body.
    struct Overlap {
        std::size_t loser, keeper;
        double volume;
    };
    std::vector<Overlap> overlaps;
};
[[nodiscard]] Result<JointMesh> mesh_together(std::span<const TriMesh> surfaces, std::span<const std::string> names,
                                              double size, const SizeOfSurface& size_at, double angle_deg,
                                              Progress& progress);

}  // namespace pliant::mesh
