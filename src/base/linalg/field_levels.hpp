// Fields of three components per node under a scalar matrix too big to factorise: conjugate gradients on several
// levels.
#pragma once

#include <memory>
#include <span>

#include "base/linalg/nested_space.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::linalg {

/// Each level smooths by one step of Jacobi's iteration, damped by the sum of magnitudes in each row (Baker, Falgout,
/// Kolev and Yang 2011), which no mesh makes unstable, and corrects on the next one: the corners of quadratic tets,
/// where there are any, and then groups of neighbouring nodes (smoothed aggregation: Vanek, Mandel and Brezina 1996);
/// the last one is factorised. Time and memory grow with the number of nodes. For matrices like a Laplacian, whose
/// smoothest motions are constants. Bit-identical on any number of cores.
class FieldLevels {
public:
    /// Keeps the `values` in single precision, except for the sum of each row: solutions are as accurate as if each
    /// coupling of two nodes were off by 6e-8 of itself. Preconditions: block 1; the matrix is positive definite;
    /// `corners`, if not null, nests in the pattern's nodes.
    FieldLevels(const SymmetricPattern& pattern, std::span<const double> values, const Nesting* corners = nullptr);
    FieldLevels(FieldLevels&&) noexcept;
    FieldLevels& operator=(FieldLevels&&) noexcept;
    ~FieldLevels();

    /// Solves in place for `count` fields, (count, nodes, 3), until the error of each, in the energy norm, is about
    /// `tolerance` relative to the solution. Returns the most iterations that one of them took. Several threads may
    /// call it at once, each with work space of its own.
    int solve(std::span<double> fields, int count, double tolerance) const;

private:
    struct State;
    class Solution;
    std::unique_ptr<State> state_;
};

}  // namespace pliant::linalg
