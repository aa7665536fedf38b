// Which rank owns a node.
#pragma once

#include <vector>

#include "geometry/mesh/tet_mesh.hpp"
#include "simulation/distributed/ranks.hpp"

namespace pliant::sim::distributed {

/// (nodes) rank of each, on root; empty on all others. Ranks own equally many nodes, with few edges between those of
/// different ranks: by PT-Scotch, or what -mat_partitioning_type in PETSC_OPTIONS names. A node in the middle of an
/// edge belongs to the rank of one of its ends. `mesh` is used on root alone.
[[nodiscard]] std::vector<int> node_owners(const Ranks& ranks, const mesh::TetMesh& mesh);

}  // namespace pliant::sim::distributed
