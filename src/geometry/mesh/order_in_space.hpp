// A spatial order: items near in space become near in memory.
#pragma once

#include <span>
#include <vector>

#include "base/core/vec3.hpp"
#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// Sorts `items` by position: layer by layer along the longest side of their box, within a layer row by row along the
/// next longest, within a row cell by cell, and within a cell by number. This is how nodes of a regular grid are
/// numbered; it suits sparse matrix products, because a row reads from a few places that advance with it. `place`:
/// position of each item (finite); `layer`: thickness of layers, rows and cells, a few items. The initial order does
/// not matter.
void order_in_space(std::span<int> items, const std::vector<Vec3>& place, double layer);

/// A layer thickness for the nodes and tets of a mesh: the side of a cube of six mean tets, m.
[[nodiscard]] double layer_of(const TetMesh& mesh);

}  // namespace pliant::mesh
