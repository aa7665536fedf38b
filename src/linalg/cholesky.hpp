// Sparse Cholesky factorisation: analyse a pattern once, factorise often, solve for many right-hand sides.
#pragma once

#include <memory>
#include <span>

#include "linalg/sparse.hpp"

namespace pliant::linalg {

/// Supernodal and multifrontal (Duff and Reid 1983), on all cores; the same bits on any number of them.
class Cholesky {
public:
    /// Orders and analyses the pattern, which is copied.
    explicit Cholesky(const SymmetricPattern& pattern);
    Cholesky(Cholesky&&) noexcept;
    Cholesky& operator=(Cholesky&&) noexcept;
    ~Cholesky();

    /// `values` (entries) belong to the pattern. False if the matrix is not positive definite; solve() must not be
    /// called then.
    [[nodiscard]] bool factorise(std::span<const double> values);

    /// Solves in place for `columns` right-hand sides, stored one after the other, (columns, size).
    void solve(std::span<double> right_hand_sides, int columns) const;

    /// Entries of the factor, as analysed: a measure of memory.
    [[nodiscard]] double factor_entries() const;
    /// Multiply-adds of one factorisation, as analysed: a measure of time.
    [[nodiscard]] double factor_work() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pliant::linalg
