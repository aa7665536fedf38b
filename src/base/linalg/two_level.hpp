// Stiffness matrices too big to factorise: conjugate gradients on two levels.
#pragma once

#include <memory>
#include <span>

#include "base/linalg/coarse_level.hpp"
#include "base/linalg/nested_space.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::linalg {

/// With more corners of quadratic tets a cycle on groups of nodes is as quick as a factor, and takes less memory.
constexpr int most_factored_corners = 5000;

/// The fine level smooths (Chebyshev polynomials of D^-1 A), the coarse one (CoarseSpace or, for quadratic tets,
/// NestedSpace) is factorised. Time and memory grow with the number of nodes, whereas those of a factorisation grow
/// with its square in bulky bodies. Bit-identical on any number of cores.
class TwoLevel {
public:
    /// Analyses the pattern. Precondition: blocks of 3.
    explicit TwoLevel(const SymmetricPattern& pattern);
    /// With the linear tets on the corners of quadratic tets as the coarse level. If there are more than
    /// `most_factored`, one cycle on groups of nodes takes the place of their factor.
    TwoLevel(const SymmetricPattern& pattern, Nesting corners, int most_factored = most_factored_corners);
    TwoLevel(TwoLevel&&) noexcept;
    TwoLevel& operator=(TwoLevel&&) noexcept;
    ~TwoLevel();

    /// `values` belong to the pattern, and are copied; `positions` (nodes, 3) are the current node positions. False if
    /// the matrix is found not to be positive definite; solve() must not be called then.
    [[nodiscard]] bool set(std::span<const double> values, std::span<const double> positions);
    /// The same in steps, for a matrix in two parts, so that memory for one suffices: take() copies the first;
    /// move_towards() adds `share` of the difference from it to `values`; prepare() makes what solves. `reuse`: what
    /// set() does is `turned`, which is as `none` if there is no coarse level yet.
    void take(std::span<const double> values, std::span<const double> positions);
    void move_towards(std::span<const double> values, double share);
    [[nodiscard]] bool prepare(Reuse reuse);
    /// True if a coarse level was made for an earlier matrix. With take() and prepare(none) of that one, then take()
    /// and prepare(turned) of this one, and set_usual_gain(), another TwoLevel of this pattern finds the same solutions
    /// to the bit.
    [[nodiscard]] bool is_turned() const;
    /// What conjugate gradients have gained in an iteration with a coarse level that was not turned.
    [[nodiscard]] double usual_gain() const;
    void set_usual_gain(double gain);

    enum class Outcome { solved, indefinite, slow };
    /// Solves in place for `columns` right-hand sides, stored one after the other, until the error, in the energy norm,
    /// is about `tolerance` relative to the solution. Accuracy is limited to single precision. Slow: `limit` iterations
    /// did not suffice, and the right-hand sides hold the solution so far.
    [[nodiscard]] Outcome solve(std::span<double> right_hand_sides, int columns, double tolerance, int limit);

    /// Linear constraints C^T x = wanted on a solution.
    struct Constraints {
        std::span<const double> normals;  ///< C, (count, size), one after the other
        std::span<const double> wanted;   ///< (count)
    };
    /// As solve(), for one right-hand side with constraints: A x + C y = b and C^T x = wanted; `multipliers` (count)
    /// <- y. A need only be positive definite among the motions that the constraints leave free. Projected conjugate
    /// gradients (Gould, Hribar and Nocedal 2001): the constraints hold to the last digit in every iteration, and the
    /// error is relative to the whole motion, that of the constraints included. Unless solved, nothing is changed. Slow
    /// also if the normals depend on each other.
    [[nodiscard]] Outcome solve_constrained(std::span<double> right_hand_side, const Constraints& constraints,
                                            std::span<double> multipliers, double tolerance, int limit);

    [[nodiscard]] int iterations() const;  ///< total of the last solve over all columns

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pliant::linalg
