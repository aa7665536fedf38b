// Which rank a node belongs to.
#pragma once

#include <vector>

#include "geometry/mesh/tet_mesh.hpp"
#include "simulation/distributed/ranks.hpp"

namespace pliant::sim::distributed {

/// (nodes) rank of each, on root; empty on all others. As many nodes for each rank as can be, and as few tets between
/// nodes of two ranks: by PT-Scotch, or what -mat_partitioning_type in PETSC_OPTIONS names. A node in the middle of an
/// edge goes with one of its ends. `mesh` counts on root alone.
[[nodiscard]] std::vector<int> node_owners(const Ranks& ranks, const mesh::TetMesh& mesh);

}  // namespace pliant::sim::distributed
