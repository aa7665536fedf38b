// Aggregates of neighbouring nodes.
#pragma once

#include <vector>

#include "base/linalg/block_rows.hpp"

namespace pliant::linalg {

/// The group of each node. Nodes of a group are adjacent; a group is about as large as a node and its neighbours, and
/// larger if there would otherwise be more than 8 sqrt(nodes) groups.
struct Aggregates {
    std::vector<int> of_node;
    int count = 0;
};
[[nodiscard]] Aggregates aggregate(const BlockRows& matrix);

}  // namespace pliant::linalg
