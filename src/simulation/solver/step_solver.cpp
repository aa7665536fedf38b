#include "simulation/solver/step_solver.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "base/core/counted.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/solver/held_multipliers.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

/// The constraint violation must be below this share of the tolerance, because the tension is sensitive to it.
constexpr double violation_share = 0.01;
constexpr std::size_t error_memory = 10;
constexpr double close = 0.05;  // an error

struct Direction {
    Eigen::VectorXd dx;          ///< (3 free)
    Eigen::VectorXd multiplier;  ///< (actuators) for the full step
    double slope_J = 0;          ///< change of energy along dx, to first order
};

class StepSolver {
public:
    StepSolver(const Equilibrium& system, Curvature& curvature, const Controls& controls, State& state,
               std::optional<Evaluation> known)
        : system_(system),
          curvature_(curvature),
          controls_(controls),
          state_(state),
          evaluation_(known ? std::move(*known) : system.evaluate(state, controls)) {
        for (std::size_t a = 0; a < controls.drives.size(); ++a) {
            if (controls.drives[a].kind == Drive::Kind::multiplier) continue;
            solved_.push_back(static_cast<Eigen::Index>(a));
            only_pull_.push_back(system.actuators()[a].only_pulls());
            by_gaps_ = by_gaps_ || system.actuators()[a].gaps() != nullptr;
        }
        penalty_weights_ = Eigen::VectorXd::Zero(state.multiplier.size());
        if (evaluation_.possible()) state_.multiplier = evaluation_.multiplier;
    }

    [[nodiscard]] const Evaluation& evaluation() const { return evaluation_; }
    /// Accepted step length of the last direction.
    [[nodiscard]] double alpha() const { return alpha_; }
    /// Flaw of the shortest step tried last; none: it is possible, but no improvement.
    [[nodiscard]] Evaluation::Flaw obstacle() const { return obstacle_; }
    [[nodiscard]] bool converged(double tolerance) const {
        return evaluation_.residual <= tolerance && evaluation_.violation <= violation_share * tolerance;
    }

    /// One iteration; false if no acceptable step was found.
    bool iterate(TangentChoice choice, double tolerance) {
        const Errors errors{std::max(evaluation_.residual, tolerance), evaluation_.violation, tolerance};
        if (!curvature_.refresh(state_, controls_, choice, errors)) return false;
        const Direction direction = find_direction();
        if (!direction.dx.allFinite()) return false;
        return search(direction);
    }

private:
    [[nodiscard]] const Actuator& actuator(Eigen::Index a) const {
        return system_.actuators()[static_cast<std::size_t>(a)];
    }

    using AddGradient = void (Actuator::*)(std::span<const double>, double, std::span<double>,
                                           std::span<const double>) const;
    /// Of the actuators with unknown multipliers, on free nodes: (3 free, solved), divided by the measure at rest.
    [[nodiscard]] Eigen::MatrixXd gradients_of(AddGradient add_gradient) const {
        Eigen::MatrixXd gradients(3 * system_.model().free_count(), static_cast<Eigen::Index>(solved_.size()));
        for (std::size_t k = 0; k < solved_.size(); ++k) {
            Eigen::VectorXd full = Eigen::VectorXd::Zero(state_.x.size());
            const Actuator& one = actuator(solved_[k]);
            (one.*add_gradient)(view(state_.x), 1 / one.rest_measure(),
                                {full.data(), static_cast<std::size_t>(full.size())}, {});
            gradients.col(static_cast<Eigen::Index>(k)) = system_.restrict_to_free(full);
        }
        return gradients;
    }

    /// Rest measures of the solved actuators: multipliers times these are energies, so that all are comparable.
    [[nodiscard]] Eigen::VectorXd scales() const {
        Eigen::VectorXd scale(static_cast<Eigen::Index>(solved_.size()));
        for (std::size_t k = 0; k < solved_.size(); ++k)
            scale[static_cast<Eigen::Index>(k)] = actuator(solved_[k]).rest_measure();
        return scale;
    }

    /// Compliance of sealed gas, in addition to that of the body, (solved).
    [[nodiscard]] Eigen::VectorXd compliances() const {
        Eigen::VectorXd compliance = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(solved_.size()));
        for (std::size_t k = 0; k < solved_.size(); ++k) {
            const Eigen::Index a = solved_[k];
            const Drive& drive = controls_.drives[static_cast<std::size_t>(a)];
            const double rest = actuator(a).rest_measure();
            if (drive.kind == Drive::Kind::gas)
                compliance[static_cast<Eigen::Index>(k)] =
                    system_.gas_compliance(drive, state_.multiplier[a]) / (rest * rest);
        }
        return compliance;
    }

    [[nodiscard]] Direction find_direction() {
        const Eigen::VectorXd gradient = system_.restrict_to_free(evaluation_.out_of_balance);
        const Eigen::MatrixXd forces = gradients_of(&Actuator::add_gradient);
        const Eigen::MatrixXd A = by_gaps_ ? gradients_of(&Actuator::add_measure_gradient) : forces;
        Eigen::MatrixXd columns(gradient.size(), 1 + A.cols());
        columns.col(0) = gradient;
        columns.rightCols(A.cols()) = forces;
        curvature_.solve(columns);

        Direction direction;
        direction.multiplier = state_.multiplier;
        direction.dx = -columns.col(0);
        Eigen::VectorXd energy_gradient = gradient;
        if (!solved_.empty()) {
            const Eigen::VectorXd scale = scales();
            const Eigen::VectorXd compliance = compliances();
            const Eigen::VectorXd now = state_.multiplier(solved_).cwiseProduct(scale);
            Eigen::MatrixXd S = A.transpose() * columns.rightCols(A.cols());
            // Violation after the unconstrained step; then the correction of the current multipliers.
            const Eigen::VectorXd violation =
                evaluation_.constraint_violation(solved_) - A.transpose() * columns.col(0);
            S.diagonal() += compliance;
            const Eigen::VectorXd change = multipliers_that_hold(S, violation + S * now, only_pull_) - now;
            direction.dx -= columns.rightCols(A.cols()) * change;
            direction.multiplier(solved_) += change.cwiseQuotient(scale);
            for (const Eigen::Index a : solved_) {
                if (actuator(a).only_pulls()) direction.multiplier[a] = std::max(direction.multiplier[a], 0.0);
            }
            for (std::size_t k = 0; k < solved_.size(); ++k) {
                const auto i = static_cast<Eigen::Index>(k);
                if (drives_measure(solved_[k])) energy_gradient -= forces.col(i) * now[i];
            }
        }
        direction.slope_J = energy_gradient.dot(direction.dx);
        return direction;
    }

    [[nodiscard]] bool drives_measure(Eigen::Index a) const {
        return controls_.drives[static_cast<std::size_t>(a)].kind == Drive::Kind::measure;
    }

    /// Halves the step until the state is possible and the merit (or the error) decreases.
    bool search(const Direction& direction) {
        raise_penalty_weights(direction);
        const double cost = constraint_penalty(evaluation_);  // a full step removes it
        const double start = evaluation_.energy_J + cost;
        const double slope = direction.slope_J - cost;
        const bool conservative = system_.conservative();
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(state_.x.size());
        system_.add_free(direction.dx, 1, motion);
        Way way(*this, motion);
        for (double alpha = way.longest(); alpha > curvature_.smallest_share() * way.longest(); alpha *= 0.5) {
            State next = state_;
            next.x = way.at(alpha);
            next.multiplier += alpha * (direction.multiplier - state_.multiplier);
            Evaluation evaluation = system_.evaluate(next, controls_);
            obstacle_ = evaluation.flaw;
            if (!evaluation.possible() || !(evaluation.min_J > 0.05 * evaluation_.min_J)) continue;
            // An accelerated step may lower the merit although it is not a descent direction; then rounding is not
            // tolerated.
            const double rounding = slope < 0 ? system_.energy_rounding_J() : 0;
            const double merit = evaluation.energy_J + constraint_penalty(evaluation);
            const bool lower = conservative && merit < start - 1e-4 * alpha * std::fabs(slope) + rounding;
            const bool nearer = conservative ? evaluation.error() < 0.5 * evaluation_.error()
                                             : evaluation.error() < (1 - 1e-3 * alpha) * allowed_error();
            if (!lower && !nearer) continue;
            accept(std::move(next), std::move(evaluation), alpha);
            return true;
        }
        return false;
    }

    /// The path of a direction. The solver's retraction may rotate the body; if that path meets something, the straight
    /// one is used, up to the largest step without contact.
    class Way {
    public:
        Way(const StepSolver& solver, const Eigen::VectorXd& motion) : solver_(solver), motion_(motion) {
            rotated_ = free_end(1);
            if (!rotated_) longest_ = solver_.system_.largest_step(solver_.state_.x, motion_, solver_.controls_);
        }
        [[nodiscard]] double longest() const { return longest_; }
        /// Precondition: alpha is at most longest(), and decreases from call to call.
        [[nodiscard]] Eigen::VectorXd at(double alpha) {
            if (alpha == 1 && rotated_) return *std::exchange(rotated_, std::nullopt);
            if (std::optional<Eigen::VectorXd> end = free_end(alpha)) return std::move(*end);
            // The straight path is known to be free up to longest() only if the whole rotated path was not free.
            const double share =
                longest_ < 1 ? 1 : solver_.system_.largest_step(solver_.state_.x, alpha * motion_, solver_.controls_);
            return solver_.state_.x + share * alpha * motion_;
        }

    private:
        /// End of the retraction for this share, if its path meets nothing.
        [[nodiscard]] std::optional<Eigen::VectorXd> free_end(double alpha) const {
            const Eigen::VectorXd& x = solver_.state_.x;
            Eigen::VectorXd end = solver_.curvature_.retract(x, alpha * motion_);
            if (solver_.system_.largest_step(x, end - x, solver_.controls_) < 1) return std::nullopt;
            return end;
        }

        const StepSolver& solver_;
        const Eigen::VectorXd& motion_;
        std::optional<Eigen::VectorXd> rotated_;  ///< end of the whole retraction
        double longest_ = 1;
    };

    /// Penalty term of the merit for the current constraint violation: zero for a cable that is not too long.
    [[nodiscard]] double constraint_penalty(const Evaluation& evaluation) const {
        double cost = 0;
        for (const Eigen::Index a : solved_) {
            const double violation = evaluation.constraint_violation[a];
            cost += penalty_weights_[a] * (actuator(a).only_pulls() ? std::max(violation, 0.0) : std::fabs(violation));
        }
        return cost;
    }

    /// Without an energy only the error can guide. It is a ratio of forces and increases when a cable begins to pull,
    /// so it may increase for a while: not above the largest of the last steps, nor initially above that of any loaded
    /// body (the non-monotone search of Grippo, Lampariello and Lucidi 1986). Close to equilibrium, and with tangents
    /// that include the skew part, an increase means that the step leads to another equilibrium: none is allowed.
    [[nodiscard]] double allowed_error() const {
        if (system_.has_skew() && evaluation_.error() < close) return evaluation_.error();
        return errors_.size() < error_memory ? 2 : *std::max_element(errors_.begin(), errors_.end());
    }

    /// The penalty weight must exceed every multiplier of the constraint, or the merit would prefer long cables.
    void raise_penalty_weights(const Direction& direction) {
        for (const Eigen::Index a : solved_) {
            if (drives_measure(a))
                penalty_weights_[a] =
                    std::max(penalty_weights_[a], 2 * std::fabs(direction.multiplier[a]) * actuator(a).rest_measure());
        }
    }

    void accept(State next, Evaluation evaluation, double alpha) {
        // The quasi-Newton pair needs both forces at the same multipliers.
        next.multiplier = evaluation.multiplier;
        const Eigen::VectorXd old_force = solved_.empty() ? evaluation_.out_of_balance : force_at(next.multiplier);
        curvature_.learn(system_.restrict_to_free(next.x - state_.x),
                         system_.restrict_to_free(evaluation.out_of_balance - old_force));
        curvature_.update_convergence(evaluation_.error(), evaluation.error());
        state_ = std::move(next);
        evaluation_ = std::move(evaluation);
        alpha_ = alpha;
        errors_.push_back(evaluation_.error());
        if (errors_.size() > error_memory) errors_.pop_front();
    }

    /// Out-of-balance force at the current positions with other multipliers.
    [[nodiscard]] Eigen::VectorXd force_at(const Eigen::VectorXd& multiplier) const {
        Eigen::VectorXd force = evaluation_.out_of_balance;
        for (const Eigen::Index a : solved_) {
            actuator(a).add_gradient(view(state_.x), multiplier[a] - state_.multiplier[a],
                                     {force.data(), static_cast<std::size_t>(force.size())},
                                     controls_.shares[static_cast<std::size_t>(a)]);
        }
        return force;
    }

    const Equilibrium& system_;
    Curvature& curvature_;
    const Controls& controls_;
    State& state_;
    Evaluation evaluation_;
    double alpha_ = 0;
    Evaluation::Flaw obstacle_ = Evaluation::Flaw::none;
    std::vector<Eigen::Index> solved_;  ///< actuators whose multiplier is unknown
    std::vector<bool> only_pull_;       ///< (solved)
    bool by_gaps_ = false;              ///< the force of one of them is not the gradient of its measure
    Eigen::VectorXd penalty_weights_;   ///< (actuators)
    std::deque<double> errors_;         ///< of the last steps
};

/// Counts iterations without progress.
class Patience {
public:
    Patience(int limit, double error) : limit_(limit), best_(error) {}
    [[nodiscard]] bool is_at_end(double error) {
        if (error < 0.9 * best_) {
            best_ = error;
            idle_ = 0;
        } else {
            ++idle_;
        }
        return limit_ > 0 && idle_ >= limit_;
    }

private:
    int limit_;
    double best_;
    int idle_ = 0;
};

IterationRecord record(Solver solver, int iteration, const Evaluation& e, double alpha) {
    return {.solver = solver,
            .iteration = iteration,
            .residual = e.residual,
            .violation = e.violation,
            .energy_J = e.energy_J,
            .alpha = alpha,
            .min_J = e.min_J};
}

std::string stuck(const StepSolver& solver) {
    const double residual = solver.evaluation().residual;
    if (solver.obstacle() == Evaluation::Flaw::none)
        return fmt::format("no step lowers the energy, residual {:.2e}", residual);
    return fmt::format("every step that lowers the energy {}, residual {:.2e}", name(solver.obstacle()), residual);
}

}  // namespace

StepOutcome solve_step(const Equilibrium& system, Curvature& curvature, const Controls& controls,
                       const StepSettings& settings, State& state, const Progress& progress,
                       std::optional<Evaluation> known) {
    StepSolver solver(system, curvature, controls, state, std::move(known));
    StepOutcome outcome;
    outcome.solver = curvature.solver();
    outcome.history.push_back(record(outcome.solver, 0, solver.evaluation(), 0));
    const int limit = settings.iteration_limit > 0 ? settings.iteration_limit : curvature.default_iteration_limit();
    Patience patience(settings.patience, solver.evaluation().error());
    const auto residual = [&] { return solver.evaluation().residual; };
    while (!(outcome.converged = solver.converged(settings.tolerance))) {
        if (progress.cancelled()) {
            outcome.reason = "cancelled";
            break;
        }
        if (outcome.iterations == limit) {
            outcome.reason = fmt::format("no convergence in {}, residual {:.2e}",
                                         counted(static_cast<std::size_t>(limit), "iteration"), residual());
            break;
        }
        ++outcome.iterations;
        if (!solver.iterate(TangentChoice::quickest, settings.tolerance) &&
            !solver.iterate(TangentChoice::exact, settings.tolerance) &&
            !solver.iterate(TangentChoice::projected, settings.tolerance)) {
            outcome.reason = stuck(solver);
            break;
        }
        outcome.history.push_back(record(outcome.solver, outcome.iterations, solver.evaluation(), solver.alpha()));
        if (patience.is_at_end(solver.evaluation().error()) && !solver.converged(settings.tolerance)) {
            outcome.reason = fmt::format("no progress in {}, residual {:.2e}",
                                         counted(static_cast<std::size_t>(settings.patience), "iteration"), residual());
            break;
        }
    }
    outcome.evaluation = solver.evaluation();
    return outcome;
}

}  // namespace pliant::sim
