// What is known about a matrix before its numbers: the order of elimination and where each of its blocks goes.
#pragma once

#include <memory>
#include <vector>

#include "base/linalg/elimination.hpp"
#include "base/linalg/panel.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::linalg {

/// Where a block of the matrix goes.
struct Source {
    int pair;        ///< of the pattern
    int row;         ///< node, counted from the top of the panel
    int column;      ///< node of the supernode
    bool transpose;  ///< the order of elimination turned the pair round
};

/// Of one unknown a node: good for any number of them.
struct Analysis {
    SymmetricPattern pattern;
    Elimination e;
    std::vector<std::vector<int>> children;  ///< (supernodes)
    std::vector<Source> sources;             ///< in the order of the supernodes
    std::vector<int> source_start;           ///< (supernodes + 1)
    /// (supernodes) where the rows below each are in the front of its parent; a stretch is within the parent's own
    /// nodes or below them
    std::vector<std::vector<Stretch>> stretches;

    /// Row of a node in the front of s: its own nodes first, then those below.
    [[nodiscard]] int local_row(int s, int node) const;
};

/// Copies the pattern, whose block is of no account.
[[nodiscard]] std::shared_ptr<const Analysis> analyse(const SymmetricPattern& pattern);

}  // namespace pliant::linalg
