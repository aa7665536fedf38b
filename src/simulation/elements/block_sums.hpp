// Sums of element contributions to the blocks of a sparse matrix.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "base/core/array_pool.hpp"
#include "base/linalg/lists.hpp"

namespace pliant::sim {

/// Batches are summed in runs, on all cores. Nearly all blocks belong to the tets of one run, which adds to them
/// directly; for blocks shared with other runs, each run has a list of its own, and the lists are added last. The same
/// bits on any number of threads.
class BlockSums {
public:
    /// A pair of nodes without a block, because one of them is held.
    static constexpr int no_slot = -1;

    BlockSums() = default;
    /// `slots` (batches, pairs, lanes) for the pairs of each batch: twice the index of the block in the matrix, which
    /// has `blocks`, plus one if the pair is transposed; or no_slot.
    BlockSums(std::vector<int> slots, std::size_t batches, std::size_t blocks);

    /// Writes (pairs, numbers of a block, lanes) for a batch; called concurrently for several batches.
    using Fill = std::function<void(std::size_t batch, double* written)>;
    /// values (blocks, size) += what `fill` writes for all batches. `size` is 1, or 9 for blocks of 3 by 3 by columns.
    void add(const Fill& fill, std::size_t size, std::span<double> values, ArrayPool<double>& scratch) const;

private:
    [[nodiscard]] std::size_t runs() const { return list_start_.size() - 1; }
    [[nodiscard]] std::size_t first_batch(std::size_t run) const { return run * batches_ / runs(); }
    [[nodiscard]] std::span<int> slots_of(std::size_t run);
    void share_out();
    template <std::size_t size>
    void add_batch(std::size_t batch, const double* written, double* values, double* list) const;

    std::size_t batches_ = 0;
    std::size_t width_ = 0;  ///< pairs * lanes
    int blocks_ = 0;
    std::vector<int> slots_;          ///< for shared blocks: places in the list, counted after all blocks
    std::vector<int> list_start_{0};  ///< (runs + 1) places in the lists of the runs before
    std::vector<int> shared_;         ///< blocks, in ascending order
    linalg::Lists uses_;              ///< for each of them, the places in all lists, in the order of the runs
};

}  // namespace pliant::sim
