#include "simulation/inverse/sensitivity.hpp"

#include <algorithm>
#include <limits>

#include "base/linalg/vectors.hpp"

namespace pliant::sim::inverse {

Result<Sensitivity> Sensitivity::create(const Stepper& stepper, const InputSpace& space, const RobotState& robot,
                                        const std::vector<bool>& pulled) {
    State state = robot.now.state;
    for (Eigen::Index i = 0; i < space.size(); ++i) {
        double& tension = state.multiplier[static_cast<Eigen::Index>(space.input(i).actuator)];
        if (pulled[static_cast<std::size_t>(i)]) tension = std::max(tension, std::numeric_limits<double>::min());
    }
    constexpr double residual = 1e-6;  // a step is tried in any case
    const KnownPattern known = known_pattern(stepper.system(), stepper.laplacian(), robot.memory.get());
    Result<Linearisation> at = Linearisation::create(stepper.system(), state, robot.controls, known, residual);
    if (!at) return tl::unexpected(at.error());
    Sensitivity made(std::move(*at));
    made.by_ = space.derivatives(made.at_);
    return made;
}

void Sensitivity::use(RowGradients rows) {
    rows_ = std::move(rows);
    learnt_.clear();
}

Eigen::VectorXd Sensitivity::multiply(const Eigen::VectorXd& inputs) {
    Eigen::VectorXd result = rows_.by_inputs * inputs;
    Derivative by = by_.front();
    by.equations *= inputs[0];
    by.direct.positions *= inputs[0];
    by.direct.multipliers *= inputs[0];
    for (Eigen::Index i = 1; i < inputs.size(); ++i) {
        if (inputs[i] == 0) continue;
        const Derivative& one = by_[static_cast<std::size_t>(i)];
        by.equations += inputs[i] * one.equations;
        by.direct.positions += inputs[i] * one.direct.positions;
        by.direct.multipliers += inputs[i] * one.direct.multipliers;
    }
    ++solutions_;
    const Result<Change> change = at_.response(by);
    if (!change) {
        status_ = tl::unexpected(change.error());
        return Eigen::VectorXd::Zero(result.size());
    }
    result += rows_.by_positions * change->positions + rows_.by_multipliers * change->multipliers;
    for (const Learnt& more : learnt_) result += more.rows * more.inputs.dot(inputs);
    return result;
}

std::optional<Adjoint> Sensitivity::adjoint(const Eigen::VectorXd& rows) {
    const Quantity sum{rows_.by_positions.transpose() * rows, rows_.by_multipliers.transpose() * rows};
    ++solutions_;
    Result<Adjoint> adjoint = at_.adjoint(sum);
    if (adjoint) return std::move(*adjoint);
    status_ = tl::unexpected(adjoint.error());
    return std::nullopt;
}

Eigen::VectorXd Sensitivity::multiply_transposed(const Eigen::VectorXd& rows) {
    Eigen::VectorXd result = rows_.by_inputs.transpose() * rows;
    const std::optional<Adjoint> solved = adjoint(rows);
    if (!solved) return Eigen::VectorXd::Zero(result.size());
    for (Eigen::Index i = 0; i < result.size(); ++i) result[i] += solved->derivative(by_[static_cast<std::size_t>(i)]);
    for (const Learnt& more : learnt_) result += more.inputs * more.rows.dot(rows);
    return result;
}

Eigen::VectorXd Sensitivity::by_tensions(const Eigen::VectorXd& rows, const std::vector<std::size_t>& cables) {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(cables.size()));
    const std::optional<Adjoint> solved = adjoint(rows);
    if (!solved) return result;
    const Eigen::VectorXd weights = at_.change_of(solved->weights).positions;
    for (std::size_t k = 0; k < cables.size(); ++k) {
        Eigen::VectorXd force = Eigen::VectorXd::Zero(weights.size());
        at_.system().actuators()[cables[k]].add_gradient(linalg::view(at_.state().x), 1, linalg::view(force),
                                                         at_.controls().shares[cables[k]]);
        result[static_cast<Eigen::Index>(k)] = -weights.dot(force);
    }
    return result;
}

void Sensitivity::learn(const Eigen::VectorXd& inputs, const Eigen::VectorXd& miss) {
    const double square = inputs.squaredNorm();
    if (square > 0) learnt_.push_back({miss / square, inputs});
}

}  // namespace pliant::sim::inverse
