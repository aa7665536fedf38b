// Two ways to solve with a tangent stiffness: by its factor, or on two levels where that would be too big.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "base/linalg/analysis.hpp"
#include "base/linalg/nested_space.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::sim {

class TangentInverse {
public:
    virtual ~TangentInverse() = default;

    /// How much it may take to make a factor of a matrix that single precision refuses: double is asked now and then,
    /// or in any case, or not at all.
    enum class Effort { little, usual, all };
    /// Takes a matrix, of which `values` must live on until the next call, and where its nodes are (3 nodes). False if
    /// it is seen not to be positive definite.
    [[nodiscard]] virtual bool set(std::span<const double> values, const Eigen::VectorXd& positions, Effort effort) = 0;
    enum class Outcome { solved, indefinite, slow };
    /// columns (3 nodes, k) <- H^-1 columns, within `error` of each solution in the norm of H; 1e-3 at best, where an
    /// `error` is smaller. Indefinite, slow: they hold how far it got, which still is a direction in which the energy
    /// falls.
    [[nodiscard]] virtual Outcome solve(Eigen::MatrixXd& columns, double error) = 0;
    /// What it knows beside the factor: with it a matrix that was taken before gives the same solutions again.
    struct Memory {
        bool in_double = false;
        bool untried = false;
        double known_error = 0;
        int trusted = 0;
        int refusals = 0;
        bool operator==(const Memory&) const = default;
    };
    [[nodiscard]] virtual Memory memory() const = 0;
    /// Puts that back; the factor at hand must be the one that it belongs to.
    virtual void restore(const Memory& memory) = 0;
    /// As set(), with a matrix that was taken before and the memory from after that.
    virtual void recall(std::span<const double> values, const Eigen::VectorXd& positions, const Memory& memory) = 0;
    /// What it costs to take a matrix and solve with it, in steps with one that is at hand.
    [[nodiscard]] virtual double factorisation_cost() const = 0;
};

/// `exact`: in double precision throughout.
[[nodiscard]] std::unique_ptr<TangentInverse> make_direct_inverse(std::shared_ptr<const linalg::Analysis> analysis,
                                                                  bool exact);
[[nodiscard]] std::unique_ptr<TangentInverse> make_two_level_inverse(const linalg::SymmetricPattern& pattern);
/// Of quadratic tets, whose corners are the second level.
[[nodiscard]] std::unique_ptr<TangentInverse> make_nested_inverse(const linalg::SymmetricPattern& pattern,
                                                                  linalg::Nesting corners);
/// Which of the two is quicker, by what is known of the pattern alone. `factor_work`: multiply-adds of a factorisation
/// with one unknown a node.
[[nodiscard]] bool two_levels_are_quicker(const linalg::SymmetricPattern& pattern, double factor_work);
/// The same of the second level that the corners of quadratic tets make.
[[nodiscard]] bool nested_levels_are_quicker(const linalg::SymmetricPattern& pattern, double factor_work);

}  // namespace pliant::sim
