// Symmetric sparse matrices that are assembled block by block on the graph of a mesh.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace pliant::linalg {

/// Lower triangle, compressed by columns. Unknown u of node i has index i * block + u.
struct SymmetricPattern {
    int block = 1;                  ///< unknowns per node
    int nodes = 0;                  ///< size of the matrix is nodes * block
    std::vector<int> column_start;  ///< (size + 1)
    std::vector<int> row;           ///< (entries), ascending in each column

    std::vector<int> node_start;  ///< (nodes + 1): node-level lower triangle, the diagonal first
    std::vector<int> node_row;    ///< (node entries), ascending in each node column

    [[nodiscard]] int size() const { return nodes * block; }
    [[nodiscard]] std::size_t entries() const { return row.size(); }

    /// Index into `node_row` of the pair (i, j), i >= j. The pair must be in the pattern.
    [[nodiscard]] int find(int i, int j) const;
    /// Adds `value(r, c)` for the block at (i, j) of the full matrix, where i >= j; for i == j only r >= c is kept.
    template <class Value>
    void add_block(std::span<double> values, int i, int j, const Value& value) const {
        const int position = find(i, j) - node_start[static_cast<std::size_t>(j)];
        for (int c = 0; c < block; ++c) {
            double* column = values.data() + column_start[static_cast<std::size_t>(j * block + c)];
            // The diagonal block of column c has block - c rows; every later one has `block`.
            double* entry = position == 0 ? column - c : column + (block - c) + (position - 1) * block;
            for (int r = position == 0 ? c : 0; r < block; ++r) entry[r] += value(r, c);
        }
    }
};

/// The pattern that couples the nodes of each clique (an element, the guide points of a cable). Clique entries below 0
/// are left out; every diagonal is present.
[[nodiscard]] SymmetricPattern make_pattern(int nodes, int block, const std::vector<std::vector<int>>& cliques);

}  // namespace pliant::linalg
