// Small groups of neighbouring nodes.
#pragma once

#include <vector>

#include "linalg/block_rows.hpp"

namespace pliant::linalg {

/// Group of each node. Nodes of a group are next to one another; groups are about as large as a node and its
/// neighbours, and larger where there would be more than 8 sqrt(nodes) of them.
struct Aggregates {
    std::vector<int> of_node;
    int count = 0;
};
[[nodiscard]] Aggregates aggregate(const BlockRows& matrix);

/// What belongs to each group, in ascending order: item[start[g]] .. item[start[g + 1]].
struct Members {
    std::vector<int> start, item;
};
[[nodiscard]] Members members_of(const std::vector<int>& group_of_item, int groups);

}  // namespace pliant::linalg
