// A closed surface has one inside, whatever its normals say: which way its shells look follows from how they are
// nested.
#pragma once

#include <cstddef>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

struct TurnedShells {
    std::size_t triangles = 0;   ///< that ran against their neighbours, and were turned
    std::size_t inside_out = 0;  ///< shells around material that looked inwards, and were turned outwards
    std::size_t cavities = 0;    ///< shells inside another one that looked outwards, and were turned inwards
};

/// Turns the closed shells of a surface: those around an even number of others' insides look outwards, around an odd
/// number inwards. A shell is what hangs together by edges of two triangles each; it is closed if it has no others. A
/// shell counts as inside another only if it neither touches nor crosses it, and becomes a cavity only if it crosses no
/// shell at all: bodies that overlap stay bodies. What is open, or has only one side, stays as it is; so do all shells
/// beyond 10000.
TurnedShells orient_by_nesting(TriMesh& surface);

}  // namespace pliant::mesh
