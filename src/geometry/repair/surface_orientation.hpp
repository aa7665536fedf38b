// Turns triangles so that neighbours agree and the surface looks outwards, as far as a damaged surface can.
#pragma once

#include <cstddef>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

struct SurfaceDamage {
    std::size_t open_edges = 0;     ///< edges of one triangle
    std::size_t crowded_edges = 0;  ///< edges of more than two
    std::size_t repeated = 0;       ///< triangles with the same corners as another, removed
    std::size_t flat = 0;           ///< triangles without area, removed
    std::size_t turned = 0;         ///< triangles that looked the other way than most of their neighbours
    bool inside_out = false;        ///< all looked inwards
};

/// Removes repeated and flat triangles, lets neighbours across edges of two triangles agree with the greater part (by
/// area) of what hangs together so, and turns everything if the signed volume is negative.
[[nodiscard]] SurfaceDamage orient(TriMesh& surface);

/// Turns the surface of one connected solid outwards: of its shells the largest is the outer one, the rest are
/// cavities. Precondition: each edge has two triangles.
void orient_solid(TriMesh& surface);

}  // namespace pliant::mesh
