// What residuals do with small changes of the inputs at one state, by products alone: a product takes one solution with
// the linearised equations, its transpose one with their transpose, and no matrix of residuals by inputs is formed.
// What has been solved for is remembered, so that along combinations of it nothing is solved again.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/inverse/goal_rows.hpp"
#include "simulation/linearisation/linearisation.hpp"

namespace pliant::sim::inverse {

class Sensitivity {
public:
    /// Cables that are in `pulled` (inputs) count as pulling although they are slack: as if they had just become taut.
    [[nodiscard]] static Result<Sensitivity> create(const Stepper& stepper, const InputSpace& space,
                                                    const RobotState& robot, const std::vector<bool>& pulled);

    /// Takes the rows of residuals at a waypoint; the linearisation is kept, what was learnt is forgotten.
    void use(RowGradients rows);
    [[nodiscard]] Linearisation& at() { return at_; }

    /// (inputs) -> (rows), (rows) -> (inputs). Where there is no solution the result is zero and status() says why.
    [[nodiscard]] Eigen::VectorXd multiply(const Eigen::VectorXd& inputs);
    [[nodiscard]] Eigen::VectorXd multiply_transposed(const Eigen::VectorXd& rows);
    /// d (weights . residuals) / dT of these cables, as if their tensions were given: tells whether it helps to pull
    /// one that is slack. (rows) -> (cables)
    [[nodiscard]] Eigen::VectorXd by_tensions(const Eigen::VectorXd& rows, const std::vector<std::size_t>& cables);
    [[nodiscard]] const Status& status() const { return status_; }

    /// `miss`: what the product with `inputs` falls short of what was found. Corrects it by the smallest change that
    /// does (Broyden 1965).
    void learn(const Eigen::VectorXd& inputs, const Eigen::VectorXd& miss);
    /// About the state that a robot, which is near, goes to with a change of its inputs: along what has been solved for
    /// by multiply() since create().
    [[nodiscard]] State expected(const Stepper& stepper, const State& now, const Eigen::VectorXd& inputs) const;
    /// How often the linearised equations were solved.
    [[nodiscard]] int solutions() const { return solutions_; }

private:
    explicit Sensitivity(Linearisation at) : at_(std::move(at)) {}
    [[nodiscard]] std::optional<Adjoint> adjoint(const Eigen::VectorXd& rows);

    [[nodiscard]] Eigen::VectorXd solved_product(const Eigen::VectorXd& direction);

    struct Learnt {
        Eigen::VectorXd rows, inputs;  ///< adds rows (inputs . v)
    };
    /// A direction of length 1, orthogonal to all others, with its product.
    struct Known {
        Eigen::VectorXd direction, product;
    };
    template <class Solve>
    [[nodiscard]] static Eigen::VectorXd product(std::vector<Known>& known, const Eigen::VectorXd& v, Eigen::Index size,
                                                 const Solve& solve);
    Linearisation at_;
    RowGradients rows_;
    std::vector<Derivative> by_;
    std::vector<Known> direct_, transposed_;
    std::vector<Change> changes_;  ///< of the state, along each of direct_
    std::vector<Learnt> learnt_;
    Status status_;
    int solutions_ = 0;
};

}  // namespace pliant::sim::inverse
