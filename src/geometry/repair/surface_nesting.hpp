// Orients the shells of a closed surface by their nesting, whatever their normals say.
#pragma once

#include <cstddef>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

struct TurnedShells {
    std::size_t triangles = 0;   ///< with an orientation opposite to their neighbours', flipped
    std::size_t inside_out = 0;  ///< shells around material with inward normals, flipped outwards
    std::size_t cavities = 0;    ///< shells inside another with outward normals, flipped inwards
};

/// Orients the closed shells of a surface: outwards if inside an even number of others, inwards if inside an odd
/// number. A shell is a set of triangles connected by edges of two triangles each; it is closed if it has no other
/// edges. A shell counts as inside another only if it neither touches nor crosses it, and becomes a cavity only if it
/// crosses no shell at all: overlapping bodies stay bodies. Open and non-orientable shells are left unchanged; so are
/// all shells beyond 10000.
TurnedShells orient_by_nesting(TriMesh& surface);

}  // namespace pliant::mesh
