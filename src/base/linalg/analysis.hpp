// Symbolic analysis of a matrix: the elimination order and the destination of each of its blocks.
#pragma once

#include <memory>
#include <vector>

#include "base/linalg/elimination.hpp"
#include "base/linalg/panel.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::linalg {

/// The destination of a block of the matrix.
struct Source {
    int pair;        ///< index in the pattern
    int row;         ///< node, counted from the top of the panel
    int column;      ///< node of the supernode
    bool transpose;  ///< the elimination order swapped row and column
};

/// For one unknown per node; serves any number of them.
struct Analysis {
    SymmetricPattern pattern;
    Elimination e;
    std::vector<std::vector<int>> children;  ///< (supernodes)
    std::vector<Source> sources;             ///< in the order of the supernodes
    std::vector<int> source_start;           ///< (supernodes + 1)
    /// (supernodes) positions of the rows below each in its parent's front; each stretch lies either within the
    /// parent's own nodes or below them
    std::vector<std::vector<Stretch>> stretches;

    /// Row of a node in the front of s: its own nodes first, then those below.
    [[nodiscard]] int local_row(int s, int node) const;
};

/// Copies the pattern; its block size is ignored.
[[nodiscard]] std::shared_ptr<const Analysis> analyse(const SymmetricPattern& pattern);

}  // namespace pliant::linalg
