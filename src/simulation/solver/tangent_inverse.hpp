// Two ways to solve with a tangent stiffness: a factorisation, or a method on levels if that would be too large.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>

#include "base/linalg/analysis.hpp"
#include "base/linalg/coarse_level.hpp"
#include "base/linalg/nested_space.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::sim {

class TangentInverse {
public:
    virtual ~TangentInverse() = default;

    /// Effort for a matrix that single precision cannot factorise: double precision is tried never,
    /// occasionally or always.
    enum class Effort { little, usual, all };
    /// Sets a matrix, of which `values` must be valid until the next call unless keeps_matrix(), and the positions of
    /// its nodes (3 nodes). False if it is found not to be positive definite.
    [[nodiscard]] virtual bool set(std::span<const double> values, const Eigen::VectorXd& positions, Effort effort) = 0;
    /// True: set() copies the matrix, and may be replaced by its steps: those of linalg::TwoLevel.
    [[nodiscard]] virtual bool keeps_matrix() const { return false; }
    virtual void take(std::span<const double> values, const Eigen::VectorXd& positions) {
        (void)values, (void)positions;
    }
    virtual void move_towards(std::span<const double> values, double share) { (void)values, (void)share; }
    [[nodiscard]] virtual bool prepare(linalg::Reuse reuse) {
        (void)reuse;
        return false;
    }
    /// True if solutions also depend on an earlier matrix: linalg::TwoLevel::is_turned().
    [[nodiscard]] virtual bool is_turned() const { return false; }
    enum class Outcome { solved, indefinite, slow };
    /// columns (3 nodes, k) <- H^-1 columns, within `error` of each solution in the norm of H, but no tighter than
    /// 1e-3. Outcomes indefinite and slow: columns hold the last iterate, which is still a descent direction.
    [[nodiscard]] virtual Outcome solve(Eigen::MatrixXd& columns, double error) = 0;
    /// As solve(), after which it is called, in a way that does not depend on how often it was solved before. False:
    /// that may be off by more than `error`, or is not offered.
    [[nodiscard]] virtual bool solve_plainly(Eigen::MatrixXd& columns, double error) const {
        (void)columns, (void)error;
        return false;
    }
    /// Linear constraints on a solution: normals^T x = wanted. `normals` are (3 nodes, k).
    struct Constraints {
        const Eigen::MatrixXd& normals;
        const Eigen::VectorXd& wanted;
    };
    /// True if solve_constrained() may be called.
    [[nodiscard]] virtual bool takes_constraints() const { return false; }
    /// H column + normals multipliers = column, with the constraints; H need only be positive definite among the
    /// motions that they leave free.
    [[nodiscard]] virtual Outcome solve_constrained(Eigen::VectorXd& column, const Constraints& constraints,
                                                    Eigen::VectorXd& multipliers, double error) {
        (void)column, (void)constraints, (void)multipliers, (void)error;
        return Outcome::slow;
    }
    /// State in addition to the factor: with it, a matrix that was set before gives the same solutions again.
    struct Memory {
        bool in_double = false;
        bool untried = false;
        double known_error = 0;
        int trusted = 0;
        int refusals = 0;
        double usual_gain = 1;  ///< on levels: linalg::TwoLevel::usual_gain()
        bool operator==(const Memory&) const = default;
    };
    [[nodiscard]] virtual Memory memory() const = 0;
    /// Restores it; the current factor must be the one that it belongs to.
    virtual void restore(const Memory& memory) = 0;
    /// As set(), with a matrix that was set before and the memory saved after that. Precondition: not keeps_matrix().
    virtual void recall(std::span<const double> values, const Memory& memory) { (void)values, (void)memory; }
    /// Cost of setting a matrix and solving, relative to a solve with an existing factor.
    [[nodiscard]] virtual double factorisation_cost() const = 0;
};

/// `exact`: in double precision throughout.
[[nodiscard]] std::unique_ptr<TangentInverse> make_direct_inverse(std::shared_ptr<const linalg::Analysis> analysis,
                                                                  bool exact);
/// Conjugate gradients on levels. `corners`: of quadratic tets, which are the second level; none: groups of nodes.
[[nodiscard]] std::unique_ptr<TangentInverse> make_levels_inverse(const linalg::SymmetricPattern& pattern,
                                                                  const std::optional<linalg::Nesting>& corners);
/// Which of the two is faster, judged by the pattern alone. `nested`: there are corners. `factor_work`: multiply-adds
/// of a factorisation with one unknown per node.
[[nodiscard]] bool levels_are_quicker(const linalg::SymmetricPattern& pattern, bool nested, double factor_work);

}  // namespace pliant::sim
