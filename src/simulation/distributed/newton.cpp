#include "simulation/distributed/newton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "base/core/counted.hpp"
#include "simulation/solver/held_multipliers.hpp"

namespace pliant::sim::distributed {
namespace {

/// As in sim::solve_step.
constexpr double violation_share = 0.01;
constexpr double smallest_alpha = 1e-7;
constexpr double smallest_J_left = 0.05;
constexpr std::size_t error_memory = 10;
constexpr int default_iteration_limit = 100;
constexpr double straight_share = 0.05;  // of what is wanted, that a step may spoil by not turning
constexpr double turning_error = 1e-3;
/// Errors of linear solutions: a direction need not be better than what is left of the residual after it.
constexpr double largest_solution_error = 1e-3, smallest_solution_error = 1e-11, share_of_wanted = 0.1;

struct Direction {
    Eigen::VectorXd dx;          ///< (3 owned)
    Eigen::VectorXd multiplier;  ///< (actuators) that goes with the full step
    double slope_J = 0;          ///< change of energy along dx, to first order
};

class Newton {
public:
    Newton(const Balance& balance, LinearSolver& linear, Turning& turning, const Controls& controls, State& state)
        : balance_(balance),
          linear_(linear),
          turning_(turning),
          controls_(controls),
          state_(state),
          evaluation_(balance.evaluate(state, controls)) {
        for (std::size_t a = 0; a < controls.drives.size(); ++a) {
            if (controls.drives[a].kind == Drive::Kind::multiplier) continue;
            solved_.push_back(static_cast<Eigen::Index>(a));
            only_pull_.push_back(balance.is_cable(a));
        }
        penalty_weights_ = Eigen::VectorXd::Zero(state.multiplier.size());
        if (evaluation_.possible()) state_.multiplier = evaluation_.multiplier;
    }

    [[nodiscard]] const Evaluation& evaluation() const { return evaluation_; }
    [[nodiscard]] double alpha() const { return alpha_; }
    [[nodiscard]] Evaluation::Flaw obstacle() const { return obstacle_; }
    [[nodiscard]] bool converged(double tolerance) const {
        return evaluation_.residual <= tolerance && evaluation_.violation <= violation_share * tolerance;
    }

    /// One iteration, with the tangent or, where that is of no use, with its projection; false if no acceptable step
    /// was found.
    bool iterate(double tolerance) {
        for (const bool project : {false, true}) {
            linear_.take(state_, project);
            const std::optional<Direction> direction = find_direction(tolerance);
            if (direction && search(*direction, tolerance)) return true;
        }
        return false;
    }

private:
    [[nodiscard]] bool drives_measure(Eigen::Index a) const {
        return controls_.drives[static_cast<std::size_t>(a)].kind == Drive::Kind::measure;
    }
    [[nodiscard]] double rest_measure(Eigen::Index a) const {
        return balance_.rest_measure(static_cast<std::size_t>(a));
    }

    [[nodiscard]] double solution_error(double tolerance) const {
        const double error = std::max(evaluation_.error(), tolerance);
        const double enough = std::max(std::min(largest_solution_error, error), share_of_wanted * tolerance / error);
        return std::clamp(enough, smallest_solution_error, 0.1);
    }

    /// Without one the tangent was not positive definite.
    [[nodiscard]] std::optional<Direction> find_direction(double tolerance) {
        const double error = solution_error(tolerance);
        Eigen::VectorXd gradient = evaluation_.out_of_balance;
        balance_.restrict_to_free(gradient);
        const auto count = static_cast<Eigen::Index>(solved_.size());
        Eigen::MatrixXd forces(gradient.size(), count), motions(gradient.size(), count);
        Eigen::VectorXd column;
        for (Eigen::Index k = 0; k < count; ++k) {
            forces.col(k) =
                balance_.measure_gradient(static_cast<std::size_t>(solved_[static_cast<std::size_t>(k)]), state_.x);
            if (!linear_.solve(forces.col(k), error, column)) return std::nullopt;
            motions.col(k) = column;
        }
        if (!linear_.solve(gradient, error, column)) return std::nullopt;
        Direction direction{-column, state_.multiplier, 0};
        Eigen::VectorXd energy_gradient = gradient;
        if (count > 0) hold_constraints(forces, motions, direction, energy_gradient);
        direction.slope_J = balance_.nodes().dot(energy_gradient, direction.dx);
        if (!std::isfinite(direction.slope_J)) return std::nullopt;
        return direction;
    }

    /// The multipliers of the full step, and what they add to it.
    void hold_constraints(const Eigen::MatrixXd& forces, const Eigen::MatrixXd& motions, Direction& direction,
                          Eigen::VectorXd& energy_gradient) {
        const auto count = static_cast<Eigen::Index>(solved_.size());
        Eigen::MatrixXd products(count, count + 1);
        products.leftCols(count) = forces.transpose() * motions;
        products.col(count) = forces.transpose() * direction.dx;
        balance_.ranks().add_up({products.data(), static_cast<std::size_t>(products.size())});
        Eigen::MatrixXd S = products.leftCols(count);
        Eigen::VectorXd scale(count);
        for (Eigen::Index k = 0; k < count; ++k) {
            const Eigen::Index a = solved_[static_cast<std::size_t>(k)];
            const Drive& drive = controls_.drives[static_cast<std::size_t>(a)];
            scale[k] = rest_measure(a);
            if (drive.kind == Drive::Kind::gas)
                S(k, k) += balance_.gas_compliance(drive, state_.multiplier[a]) / (scale[k] * scale[k]);
        }
        const Eigen::VectorXd now = state_.multiplier(solved_).cwiseProduct(scale);
        const Eigen::VectorXd violation = evaluation_.constraint_violation(solved_) + products.col(count);
        const Eigen::VectorXd change = multipliers_that_hold(S, violation + S * now, only_pull_) - now;
        direction.dx -= motions * change;
        direction.multiplier(solved_) += change.cwiseQuotient(scale);
        for (std::size_t k = 0; k < solved_.size(); ++k) {
            const Eigen::Index a = solved_[k];
            const auto i = static_cast<Eigen::Index>(k);
            if (only_pull_[k]) direction.multiplier[a] = std::max(direction.multiplier[a], 0.0);
            if (drives_measure(a)) energy_gradient -= forces.col(i) * now[i];
        }
    }

    /// Halves the step until the state is possible and the merit (or the error) goes down.
    bool search(const Direction& direction, double tolerance) {
        for (const Eigen::Index a : solved_)
            if (drives_measure(a))
                penalty_weights_[a] =
                    std::max(penalty_weights_[a], 2 * std::fabs(direction.multiplier[a]) * rest_measure(a));
        const double cost = constraint_penalty(evaluation_);  // a full step removes it
        const double start = evaluation_.energy_J + cost;
        const double slope = direction.slope_J - cost;
        const bool conservative = balance_.conservative();
        const Eigen::VectorXd motion = balance_.nodes().spread(direction.dx);
        const bool straight = evaluation_.error() * evaluation_.error() < straight_share * tolerance;
        for (double alpha = 1; alpha > smallest_alpha; alpha *= 0.5) {
            State next = state_;
            next.x += alpha * motion;
            if (!straight) next.x = turning_.rotate({.now = state_.x.data(), .end = next.x.data()}, turning_error);
            next.multiplier += alpha * (direction.multiplier - state_.multiplier);
            Evaluation evaluation = balance_.evaluate(next, controls_);
            obstacle_ = evaluation.flaw;
            if (!evaluation.possible() || !(evaluation.min_J > smallest_J_left * evaluation_.min_J)) continue;
            const double rounding = slope < 0 ? balance_.energy_rounding_J() : 0;
            const double merit = evaluation.energy_J + constraint_penalty(evaluation);
            const bool lower = conservative && merit < start - 1e-4 * alpha * std::fabs(slope) + rounding;
            const bool nearer = conservative ? evaluation.error() < 0.5 * evaluation_.error()
                                             : evaluation.error() < (1 - 1e-3 * alpha) * allowed_error();
            if (!lower && !nearer) continue;
            next.multiplier = evaluation.multiplier;
            state_ = std::move(next);
            evaluation_ = std::move(evaluation);
            alpha_ = alpha;
            errors_.push_back(evaluation_.error());
            if (errors_.size() > error_memory) errors_.pop_front();
            return true;
        }
        return false;
    }

    [[nodiscard]] double constraint_penalty(const Evaluation& evaluation) const {
        double cost = 0;
        for (std::size_t k = 0; k < solved_.size(); ++k) {
            const double violation = evaluation.constraint_violation[solved_[k]];
            cost += penalty_weights_[solved_[k]] * (only_pull_[k] ? std::max(violation, 0.0) : std::fabs(violation));
        }
        return cost;
    }

    /// Without an energy only the error can guide; it may rise for a while.
    [[nodiscard]] double allowed_error() const {
        return errors_.size() < error_memory ? 2 : *std::max_element(errors_.begin(), errors_.end());
    }

    const Balance& balance_;
    LinearSolver& linear_;
    Turning& turning_;
    const Controls& controls_;
    State& state_;
    Evaluation evaluation_;
    double alpha_ = 0;
    Evaluation::Flaw obstacle_ = Evaluation::Flaw::none;
    std::vector<Eigen::Index> solved_;  ///< actuators whose multiplier is unknown
    std::vector<bool> only_pull_;       ///< (solved)
    Eigen::VectorXd penalty_weights_;   ///< (actuators)
    std::deque<double> errors_;         ///< of the last steps
};

IterationRecord record(int iteration, const Evaluation& e, double alpha) {
    return {.solver = Solver::newton,
            .iteration = iteration,
            .residual = e.residual,
            .violation = e.violation,
            .energy_J = e.energy_J,
            .alpha = alpha,
            .min_J = e.min_J};
}

}  // namespace

StepOutcome solve_step(const Balance& balance, LinearSolver& linear, Turning& turning, const Controls& controls,
                       const StepSettings& settings, State& state) {
    Newton newton(balance, linear, turning, controls, state);
    StepOutcome outcome;
    outcome.solver = Solver::newton;
    outcome.history.push_back(record(0, newton.evaluation(), 0));
    const int limit = settings.iteration_limit > 0 ? settings.iteration_limit : default_iteration_limit;
    while (!(outcome.converged = newton.converged(settings.tolerance))) {
        const double residual = newton.evaluation().residual;
        if (outcome.iterations == limit) {
            outcome.reason = fmt::format("no convergence in {}, residual {:.2e}",
                                         counted(static_cast<std::size_t>(limit), "iteration"), residual);
            break;
        }
        ++outcome.iterations;
        if (!newton.iterate(settings.tolerance)) {
            outcome.reason = newton.obstacle() == Evaluation::Flaw::none
                                 ? fmt::format("no step lowers the energy, residual {:.2e}", residual)
                                 : fmt::format("every step that lowers the energy {}, residual {:.2e}",
                                               name(newton.obstacle()), residual);
            break;
        }
        outcome.history.push_back(record(outcome.iterations, newton.evaluation(), newton.alpha()));
    }
    outcome.evaluation = newton.evaluation();
    return outcome;
}

}  // namespace pliant::sim::distributed
