// Symmetric sparse matrices, assembled block by block on the graph of a mesh.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "base/linalg/lists.hpp"

namespace pliant::linalg {

/// Lower triangle of blocks, compressed by columns of nodes. Unknown u of node i has index i * block + u. Values: every
/// block is stored in full, column by column, in the order of `node_row`; diagonal blocks hold both triangles, of which
/// the lower one is used.
struct SymmetricPattern {
    int block = 1;                ///< unknowns per node
    int nodes = 0;                ///< the matrix has nodes * block rows
    std::vector<int> node_start;  ///< (nodes + 1)
    std::vector<int> node_row;    ///< (node pairs), ascending in each column, the diagonal first
    /// (nodes, or none) where the nodes are, in any unit: speeds up the search for a good elimination order
    std::vector<std::array<double, 3>> points{};

    [[nodiscard]] int size() const { return nodes * block; }
    /// Length of the values array.
    [[nodiscard]] std::size_t entries() const { return node_row.size() * block_entries(); }
    [[nodiscard]] std::size_t block_entries() const { return static_cast<std::size_t>(block) * block; }

    /// Index into `node_row` of the pair (i, j), i >= j. The pair must be in the pattern.
    [[nodiscard]] int find(int i, int j) const;
    /// True if the pair (i, j), i >= j, is in the pattern.
    [[nodiscard]] bool holds(int i, int j) const;
    /// Adds `value(r, c)` for the block at (i, j) of the full matrix, where i >= j.
    template <class Value>
    void add_block(std::span<double> values, int i, int j, const Value& value) const {
        double* entry = values.data() + static_cast<std::size_t>(find(i, j)) * block_entries();
        for (int c = 0; c < block; ++c) {
            for (int r = 0; r < block; ++r) *entry++ += value(r, c);
        }
    }
};

/// The pattern that couples the nodes of each clique (an element, the guide points of a cable). Negative entries are
/// skipped; every diagonal is present.
[[nodiscard]] SymmetricPattern make_pattern(int nodes, int block, const Lists& cliques);

/// The blocks of each row left of the diagonal.
struct LeftBlocks {
    Lists column;           ///< (nodes) their columns, ascending
    std::vector<int> pair;  ///< of each of these items, as an index into `node_row`
};
[[nodiscard]] LeftBlocks blocks_left_of_diagonal(const SymmetricPattern& pattern);

/// result (size) += factor * matrix * v (size).
void add_product(const SymmetricPattern& pattern, std::span<const double> values, std::span<const double> v,
                 double factor, std::span<double> result);

}  // namespace pliant::linalg
