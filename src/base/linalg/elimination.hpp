// Symbolic elimination of a symmetric matrix: the order of the nodes, the supernodes, and the elimination tree.
#pragma once

#include <vector>

#include "base/linalg/sparse.hpp"

namespace pliant::linalg {

/// Nodes are numbered in elimination order. Nodes first[s] .. first[s+1] form supernode s: their columns of the factor
/// have the same rows, its own nodes and then row[row_start[s]] .. row[row_start[s+1]].
/// Children come before their parents. Davis, Direct Methods for Sparse Linear Systems, chapter 4.
struct Elimination {
    std::vector<int> position;   ///< (nodes) place of each node of the pattern in the order
    std::vector<int> first;      ///< (supernodes + 1)
    std::vector<int> row_start;  ///< (supernodes + 1)
    std::vector<int> row;        ///< rows below the supernodes, ascending in each
    std::vector<int> parent;     ///< (supernodes) -1 at a root

    [[nodiscard]] int supernodes() const { return static_cast<int>(parent.size()); }
    [[nodiscard]] int columns(int s) const { return first[s + 1] - first[s]; }
    [[nodiscard]] int rows_below(int s) const { return row_start[s + 1] - row_start[s]; }
};

/// By nested dissection. Small supernodes are merged where that stores few zeros, because longer loops are faster.
[[nodiscard]] Elimination eliminate(const SymmetricPattern& pattern);

}  // namespace pliant::linalg
