// Aggregates of neighbouring nodes.
#pragma once

#include <span>
#include <vector>

namespace pliant::linalg {

/// The group of each node. Nodes of a group are adjacent.
struct Aggregates {
    std::vector<int> of_node;
    int count = 0;
};

/// The neighbours of each node, itself included: those of i are column[start[i]] .. column[start[i + 1]].
struct Neighbours {
    std::span<const int> start;  ///< (nodes + 1)
    std::span<const int> column;
};

/// Groups about as large as a node and its neighbours, and larger if there would otherwise be more than 4 sqrt(nodes).
[[nodiscard]] Aggregates aggregate(const Neighbours& neighbours);
/// Groups about as large as a node and its neighbours, however many there are.
[[nodiscard]] Aggregates take_neighbourhoods(const Neighbours& neighbours);

}  // namespace pliant::linalg
