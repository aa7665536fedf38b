// An order in which what is near in space is near in memory.
#pragma once

#include <span>
#include <vector>

#include "base/core/vec3.hpp"
#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// Puts `items` in order: layer by layer along the longest side of their box, in a layer row by row along the next one,
/// and in a row cell by cell; in a cell by their numbers. So the nodes of a regular grid are numbered, and it is good
/// for products of sparse matrices: a row reads from a few places, which move on with it. `place` says where each item
/// is (finite); `layer` is how thick layers, rows and cells are, a few items. The order they came in does not matter.
void order_in_space(std::span<int> items, const std::vector<Vec3>& place, double layer);

/// Good for the nodes of a mesh and for its tets: the side of a cube of six mean tets, m.
[[nodiscard]] double layer_of(const TetMesh& mesh);

}  // namespace pliant::mesh
