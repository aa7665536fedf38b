// Sparse Cholesky factorisation: analyse a pattern once, factorise often, solve for many right-hand sides.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "base/linalg/analysis.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::linalg {

/// Precision of the factor. Single takes half the memory and about half the time.
enum class Precision { single_, double_ };

/// Supernodal and multifrontal (Duff and Reid 1983), on all cores; bit-identical on any number of them.
class Cholesky {
public:
    /// Orders and analyses the pattern, which is copied.
    explicit Cholesky(const SymmetricPattern& pattern, Precision precision = Precision::double_);
    /// With an existing analysis, for `block` unknowns per node, 1 or 3.
    Cholesky(std::shared_ptr<const Analysis> analysis, int block, Precision precision = Precision::double_);
    Cholesky(Cholesky&&) noexcept;
    Cholesky& operator=(Cholesky&&) noexcept;
    ~Cholesky();

    /// Discards the factor; the analysis is kept.
    void use(Precision precision);
    [[nodiscard]] Precision precision() const;

    /// `values` (entries) belong to the pattern. False if the matrix is not positive definite in the precision of the
    /// factor; solve() must not be called then.
    [[nodiscard]] bool factorise(std::span<const double> values);

    /// Frees the work space of factorise(), about as large as the factor; the next call allocates it again.
    void release_work_space();

    /// Solves in place for `columns` right-hand sides, stored one after the other, (columns, size).
    void solve(std::span<double> right_hand_sides, int columns) const;

    /// Solves in place for `count` fields of three components per node, (count, nodes, 3): each component is a
    /// right-hand side. Faster than solve() with all of them. Precondition: block 1.
    void solve_fields(std::span<double> fields, int count) const;

    /// result (unknowns, unknowns) <- these rows and columns of the inverse of the matrix. A solution for each of them
    /// would go down and up the whole elimination tree; this goes down from them to the root.
    void inverse_part(std::span<const int> unknowns, std::span<double> result) const;

    /// As solve(), followed by conjugate gradients with the factor as preconditioner until the error, in the energy
    /// norm of the matrix, is about `tolerance` relative to the solution; `values` are those of the factor. Returns the
    /// error of the first iteration, an upper bound of the error of solve() alone, or nothing if `limit` further
    /// iterations do not reach the tolerance.
    [[nodiscard]] std::optional<double> solve_and_refine(std::span<const double> values,
                                                         std::span<double> right_hand_sides, int columns,
                                                         double tolerance, int limit) const;

    /// Entries of the factor, as analysed: a measure of memory.
    [[nodiscard]] double factor_entries() const;
    /// Multiply-adds of one factorisation, as analysed: a measure of time.
    [[nodiscard]] double factor_work() const;
    [[nodiscard]] const std::shared_ptr<const Analysis>& analysis() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pliant::linalg
