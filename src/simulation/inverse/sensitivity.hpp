// Derivatives of residuals with respect to the inputs at one state, as products. Of few inputs or few residuals all are
// solved for at once, which costs little more than one solve. Otherwise a product takes one solve with the linearised
// equations, a product with the transpose one transposed solve, and the matrix of residuals by inputs is never formed;
// products are stored, so that combinations of earlier directions need no further solve.
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
    [[nodiscard]] static Result<Sensitivity> create(const Stepper& stepper, const InputSpace& space,
                                                    const RobotState& robot);
    /// Treats these cables as taut although they are slack: as if they had just become taut. use() must follow.
    void tighten(const InputSpace& space, const std::vector<std::size_t>& cables);
    /// Treats these cables as slack although they are taut. use() must follow.
    void slacken(const InputSpace& space, const std::vector<std::size_t>& cables);
    /// (rows) the change of the residuals as slackened cables lose the tensions that they have in `now`. Until the next
    /// call, predictions contain it too.
    [[nodiscard]] Eigen::VectorXd release(const std::vector<std::size_t>& cables, const State& now);

    /// Sets the rows of residuals of a waypoint; the linearisation is kept, Broyden updates are discarded.
    void use(RowGradients rows);
    [[nodiscard]] Linearisation& at() { return at_; }

    /// (inputs) -> (rows), (rows) -> (inputs). If a solve fails, the result is zero and status() gives the error.
    [[nodiscard]] Eigen::VectorXd multiply(const Eigen::VectorXd& inputs);
    [[nodiscard]] Eigen::VectorXd multiply_transposed(const Eigen::VectorXd& rows);
    /// d (weights . residuals) / dT of these cables, as if their tensions were prescribed: shows whether tightening a
    /// slack cable helps. (rows) -> (cables)
    [[nodiscard]] Eigen::VectorXd by_tensions(const Eigen::VectorXd& rows, const std::vector<std::size_t>& cables);
    /// (rows) their derivatives with respect to the tension of this cable, likewise.
    [[nodiscard]] Eigen::VectorXd rows_by_tension(std::size_t cable);
    [[nodiscard]] const Status& status() const { return status_; }

    /// `miss`: difference between the observed change and the product with `inputs`. Corrects the product by the
    /// smallest update that removes it (Broyden 1965).
    void learn(const Eigen::VectorXd& inputs, const Eigen::VectorXd& miss);
    /// (actuators) predicted for a nearby robot after a change of its inputs: negative for a cable that would push.
    [[nodiscard]] Eigen::VectorXd expected_multipliers(const State& now, const Eigen::VectorXd& inputs);
    /// Its predicted state, in which no cable pushes.
    [[nodiscard]] State expected(const Stepper& stepper, const State& now, const Eigen::VectorXd& inputs);
    /// Number of solves with the linearised equations; combinations of what is known are none.
    [[nodiscard]] int solutions() const { return solutions_; }

private:
    explicit Sensitivity(Linearisation at) : at_(std::move(at)) {}
    /// Number of inputs, or of residuals, up to which all are solved for at once.
    static constexpr Eigen::Index most_at_once = 6;
    [[nodiscard]] Quantity quantity(const Eigen::VectorXd& rows) const;
    [[nodiscard]] std::optional<Adjoint> adjoint(const Eigen::VectorXd& rows);
    [[nodiscard]] Change no_change() const;
    [[nodiscard]] Eigen::VectorXd rows_of(const Change& change) const;
    [[nodiscard]] std::vector<Change> responses_to_tensions(const std::vector<std::size_t>& cables);
    [[nodiscard]] bool drive_constraints() const;
    void solve_few();
    void solve_for_inputs();
    void solve_for_rows();
    [[nodiscard]] bool knows_inputs() const {
        return static_cast<Eigen::Index>(direct_.size()) == rows_.by_inputs.cols();
    }
    [[nodiscard]] bool knows_rows() const {
        return static_cast<Eigen::Index>(transposed_.size()) == rows_.by_inputs.rows();
    }

    [[nodiscard]] Derivative derivative(const Eigen::VectorXd& direction) const;
    [[nodiscard]] Eigen::VectorXd direct_product(const Eigen::VectorXd& inputs);
    [[nodiscard]] Change change_along(const Eigen::VectorXd& inputs);
    [[nodiscard]] Eigen::VectorXd solved_product(const Eigen::VectorXd& direction);
    [[nodiscard]] Eigen::VectorXd product_of(const Eigen::VectorXd& direction, const Change& change) const;
    [[nodiscard]] Eigen::VectorXd product_of(const Eigen::VectorXd& rows, const Adjoint& adjoint) const;

    struct Learnt {
        Eigen::VectorXd rows, inputs;  ///< a rank-one update: adds rows (inputs . v)
    };
    /// A unit direction, orthogonal to all others, and its product.
    struct Known {
        Eigen::VectorXd direction, product;
    };
    template <class Solve>
    [[nodiscard]] static Eigen::VectorXd product(std::vector<Known>& known, const Eigen::VectorXd& v, Eigen::Index size,
                                                 const Solve& solve);
    Linearisation at_;
    RowGradients rows_;
    std::vector<Derivative> by_;
    bool begun_ = false;  ///< solve_few() was called
    std::vector<Known> direct_, transposed_;
    std::vector<Change> changes_;     ///< of the state, along each of direct_
    std::optional<Change> released_;  ///< of the state, as cables let go
    std::vector<Learnt> learnt_;
    Status status_;
    int solutions_ = 0;
};

}  // namespace pliant::sim::inverse
