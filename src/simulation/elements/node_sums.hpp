// Sums of element contributions at the nodes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/core/parallel.hpp"
#include "base/linalg/lists.hpp"
#include "simulation/elements/element_kernels.hpp"

namespace pliant::sim {

/// Batches are summed in pieces, each with a short list of the nodes that it touches, and then the lists are summed
/// node by node: nearly all additions happen in the nearest cache, and pieces do not wait for one another. The same
/// bits on any number of threads.
class NodeSums {
public:
    NodeSums() = default;
    /// `nodes`: of each batch, (batches, nodes_per_tet, lanes).
    NodeSums(std::span<const int> nodes, std::size_t nodes_per_tet, std::size_t node_count);

    /// Total size of all lists, in numbers.
    [[nodiscard]] std::size_t space() const { return stride * list_start_.back(); }

    /// Calls piece(k, first batch, one past the last) for all pieces, concurrently.
    template <class Piece>
    void for_pieces(const Piece& piece) const {
        parallel_for(pieces(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                piece(k, k * batches_per_piece, std::min(batches_, (k + 1) * batches_per_piece));
        });
    }
    [[nodiscard]] std::size_t pieces() const { return list_start_.size() - 1; }

    /// In `lists` (space): clears the list of a piece; adds forces (nodes_per_tet, 3, lanes) of a batch to the list of
    /// its piece.
    void clear(std::size_t piece, double* lists) const;
    void add(std::size_t batch, const double* forces, double* lists) const;
    /// result (3n) += the lists of all pieces.
    void gather(const double* lists, std::span<double> result) const;

private:
    static constexpr std::size_t batches_per_piece = 32;
    static constexpr std::size_t stride = 4;  ///< numbers per node in a list: three, and one for padding

    std::size_t width_ = 0;  ///< nodes_per_tet * lanes
    std::size_t batches_ = 0;
    std::vector<std::uint16_t> place_;           ///< (batches, nodes_per_tet, lanes) in the list of the piece
    std::vector<std::size_t> list_start_ = {0};  ///< (pieces + 1) nodes of the lists before
    linalg::Lists uses_;  ///< of each node, the places in the lists that add up to its sum, in the order of the pieces
};

}  // namespace pliant::sim
