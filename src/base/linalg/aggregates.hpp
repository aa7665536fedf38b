// Small groups of neighbouring nodes.
#pragma once

#include <vector>

#include "base/linalg/block_rows.hpp"

namespace pliant::linalg {

/// Group of each node. Nodes of a group are next to one another; groups are about as large as a node and its
/// neighbours, and larger where there would be more than 8 sqrt(nodes) of them.
struct Aggregates {
    std::vector<int> of_node;
    int count = 0;
};
[[nodiscard]] Aggregates aggregate(const BlockRows& matrix);

}  // namespace pliant::linalg
