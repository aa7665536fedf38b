// The processes that solve one robot together: sums, agreement on errors, and messages.
#pragma once

#include <mpi.h>

#include <span>
#include <string>

#include "base/core/error.hpp"

namespace pliant::sim::distributed {

/// All functions are collective: every rank calls them, in the same order.
class Ranks {
public:
    /// `comm` must outlive it.
    explicit Ranks(MPI_Comm comm);

    [[nodiscard]] MPI_Comm comm() const { return comm_; }
    [[nodiscard]] int own() const { return own_; }
    [[nodiscard]] int count() const { return count_; }
    /// The rank that reads the robot and prints.
    [[nodiscard]] bool is_root() const { return own_ == 0; }

    /// Replaces each number by the sum over all ranks, with the same bits on each.
    void add_up(std::span<double> numbers) const;
    [[nodiscard]] double sum(double own) const;
    [[nodiscard]] double smallest(double own) const;
    [[nodiscard]] double largest(double own) const;
    [[nodiscard]] int largest(int own) const;

    /// On all ranks, the error of the first rank that has one. Waiting ranks sleep, so that one of them may use all
    /// cores.
    [[nodiscard]] Status agree(const Status& own) const;
    /// Root's bytes, to all ranks.
    void broadcast(std::string& bytes) const;
    /// From root to one other rank, of any length. Not collective: called by these two.
    void send(const std::string& bytes, int to) const;
    [[nodiscard]] std::string receive() const;

private:
    MPI_Comm comm_;
    int own_ = 0, count_ = 1;
};

}  // namespace pliant::sim::distributed
