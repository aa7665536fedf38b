// How the coarse level of a two-level solver is solved: by a factor or, where that would be too large, by one cycle of
// further levels.
#pragma once

#include <memory>
#include <span>

#include "base/linalg/coarse_level.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::linalg {

class CoarseSolver {
public:
    virtual ~CoarseSolver() = default;

    /// `values` belong to the pattern and must stay valid until the next call; `positions` (nodes, 3) are those of its
    /// nodes. False: not positive definite.
    [[nodiscard]] virtual bool set(std::span<const double> values, std::span<const double> positions, Reuse reuse) = 0;
    /// In place, for one or two right-hand sides stored one after the other: the same symmetric and positive definite
    /// operator until the next set() or build(), to single precision.
    virtual void solve(std::span<double> right_hand_sides, int columns) = 0;
    /// True if some of it was made for an earlier matrix, and rotated.
    [[nodiscard]] virtual bool is_turned() const { return false; }
    /// Makes all of it anew, for the present matrix; false: not positive definite. Precondition: is_turned().
    [[nodiscard]] virtual bool build() { return true; }
};

/// A matrix that single precision cannot factorise is factorised in double precision.
[[nodiscard]] std::unique_ptr<CoarseSolver> make_factored_solver(const SymmetricPattern& pattern);
/// Smoothing, and groups of nodes as the next level, which is factorised. Precondition: blocks of 3, whose unknowns are
/// displacements of nodes.
[[nodiscard]] std::unique_ptr<CoarseSolver> make_grouped_solver(const SymmetricPattern& pattern);

}  // namespace pliant::linalg
