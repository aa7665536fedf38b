// Orients triangles consistently and outwards, as far as a damaged surface allows.
#pragma once

#include <cstddef>
#include <string>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

struct SurfaceDamage {
    std::size_t open_edges = 0;     ///< edges of one triangle
    std::size_t crowded_edges = 0;  ///< edges of more than two
    std::size_t repeated = 0;       ///< triangles with the same corners as another, removed
    std::size_t flat = 0;           ///< triangles without area, removed
    std::size_t turned = 0;         ///< triangles that were opposite to most of their neighbours
    bool inside_out = false;        ///< all normals pointed inwards
};

/// Removes repeated and flat triangles, orients each part connected by edges of two triangles like the majority (by
/// area) of its triangles, and flips everything if the signed volume is negative.
[[nodiscard]] SurfaceDamage orient(TriMesh& surface);

/// "3 open edges, 1 flat triangle"; empty if there is no damage.
[[nodiscard]] std::string describe(const SurfaceDamage& damage);

/// A surface as the mesher takes it, and what was wrong with it.
struct JudgedSurface {
    TriMesh sound;  ///< without seams, flat and repeated triangles, oriented
    SurfaceDamage damage;
};
[[nodiscard]] JudgedSurface judged(const TriMesh& surface);

/// Orients the surface of one connected solid outwards: the largest shell is the outer one, the rest are cavities.
/// Precondition: each edge has two triangles.
void orient_solid(TriMesh& surface);

}  // namespace pliant::mesh
