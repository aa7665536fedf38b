// Adds the Hessian of an energy of a few nodes that are all coupled: one block for every pair.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/linalg/lists.hpp"
#include "base/linalg/small.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::sim {

/// values += block_of(a, b), a Matrix3, at row nodes[a] and column nodes[b] of a pattern (block 3) that holds all
/// pairs. `index` (n) of each node in it; -1: not in it.
template <class BlockOf>
void add_node_blocks(std::span<const int> nodes, const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                     std::span<double> values, const BlockOf& block_of) {
    for (std::size_t b = 0; b < nodes.size(); ++b) {
        const int column = index[static_cast<std::size_t>(nodes[b])];
        if (column < 0) continue;
        for (std::size_t a = 0; a < nodes.size(); ++a) {
            const int row = index[static_cast<std::size_t>(nodes[a])];
            if (row < column) continue;
            const linalg::Matrix3 block = block_of(a, b);
            pattern.add_block(values, row, column, [&](int r, int c) { return block(r, c); });
        }
    }
}

/// Appends the nodes as one clique of that pattern.
inline void append_node_clique(std::span<const int> nodes, const std::vector<int>& index, linalg::Lists& cliques) {
    std::vector<int> clique;
    for (const int node : nodes) clique.push_back(index[static_cast<std::size_t>(node)]);
    cliques.push_back(clique);
}

}  // namespace pliant::sim
