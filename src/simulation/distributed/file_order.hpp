// Reorders data of nodes or tets from the ranks' order into that of the whole mesh, and back: files do not depend on
// the number of ranks.
#pragma once

#include <petscvec.h>

#include <span>
#include <vector>

#include "simulation/distributed/petsc.hpp"
#include "simulation/distributed/ranks.hpp"

namespace pliant::sim::distributed {

/// All functions are collective.
class FileOrder {
public:
    /// `numbers`: indices in the whole mesh, which has `total` of them, of the nodes or tets that this rank owns. Each
    /// is owned by one rank.
    FileOrder(const Ranks& ranks, std::span<const int> numbers, int total);

    [[nodiscard]] int total() const { return total_; }
    /// Of the whole table, this rank reads and writes the rows from first() on.
    [[nodiscard]] int first() const { return first_; }
    [[nodiscard]] int rows() const { return rows_; }

    /// (owned, width) -> (rows, width).
    [[nodiscard]] std::vector<double> sorted(std::span<const double> own, int width) const;
    /// (rows, width) -> (owned, width).
    [[nodiscard]] std::vector<double> given_back(std::span<const double> sorted, int width) const;

private:
    [[nodiscard]] std::vector<double> moved(std::span<const double> from, int width, bool back) const;

    Ranks ranks_;
    std::vector<int> numbers_;
    int total_ = 0, first_ = 0, rows_ = 0;
};

}  // namespace pliant::sim::distributed
