// Sparse Cholesky factorisation: analyse a pattern once, factorise often, solve for many right-hand sides.
#pragma once

#include <memory>
#include <span>

#include "linalg/sparse.hpp"

namespace pliant::linalg {

/// CHOLMOD (supernodal, METIS on the graph of nodes) behind a small door; single-threaded, the same bits every time.
class Cholesky {
public:
    /// Orders and analyses the pattern, which is copied.
    explicit Cholesky(const SymmetricPattern& pattern);
    Cholesky(Cholesky&&) noexcept;
    Cholesky& operator=(Cholesky&&) noexcept;
    ~Cholesky();

    /// `values` (entries) belong to the pattern. False if the matrix is not positive definite (or memory ran out);
    /// solve() must not be called then.
    [[nodiscard]] bool factorise(std::span<const double> values);

    /// Solves in place for `columns` right-hand sides, stored one after the other, (columns, size).
    void solve(std::span<double> right_hand_sides, int columns) const;

    /// Entries of the factor, as analysed: a measure of memory and time.
    [[nodiscard]] double factor_entries() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pliant::linalg
