#include "simulation/solver/step_solver.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <utility>

#include "base/core/counted.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/solver/line_search.hpp"
#include "simulation/solver/solved_actuators.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

SolvedActuators solved_actuators(const Equilibrium& system, const Controls& controls) {
    std::vector<bool> only_pulls;
    std::vector<double> rest_measures;
    for (const Actuator& actuator : system.actuators()) {
        only_pulls.push_back(actuator.only_pulls());
        rest_measures.push_back(actuator.rest_measure());
    }
    return {controls.drives, only_pulls, rest_measures};
}

class StepSolver {
public:
    StepSolver(const Equilibrium& system, Curvature& curvature, const Controls& controls, State& state,
               std::optional<Evaluation> known)
        : system_(system),
          curvature_(curvature),
          controls_(controls),
          state_(state),
          evaluation_(known ? std::move(*known) : system.evaluate(state, controls)),
          solved_(solved_actuators(system, controls)),
          search_(solved_, system.actuators().size(),
                  {system.conservative(), system.has_skew(), system.energy_rounding_J()}) {
        for (const Eigen::Index a : solved_.actuators()) by_gaps_ = by_gaps_ || actuator(a).gaps() != nullptr;
        if (evaluation_.possible()) state_.multiplier = evaluation_.multiplier;
    }

    [[nodiscard]] const Evaluation& evaluation() const { return evaluation_; }
    /// Accepted step length of the last direction.
    [[nodiscard]] double alpha() const { return alpha_; }
    [[nodiscard]] Evaluation::Flaw obstacle() const { return search_.obstacle(); }
    [[nodiscard]] bool converged(double tolerance) const { return is_converged(evaluation_, tolerance); }

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
        Eigen::MatrixXd gradients(3 * system_.model().free_count(), solved_.count());
        for (Eigen::Index k = 0; k < solved_.count(); ++k) {
            Eigen::VectorXd full = Eigen::VectorXd::Zero(state_.x.size());
            const Actuator& one = actuator(solved_.actuators()[static_cast<std::size_t>(k)]);
            (one.*add_gradient)(view(state_.x), 1 / one.rest_measure(),
                                {full.data(), static_cast<std::size_t>(full.size())}, {});
            gradients.col(k) = system_.restrict_to_free(full);
        }
        return gradients;
    }

    /// Motion of the free nodes and change of the scaled multipliers of the solved actuators.
    struct Move {
        Eigen::VectorXd dx, change;
    };

    [[nodiscard]] Direction find_direction() {
        const Eigen::VectorXd gradient = system_.restrict_to_free(evaluation_.out_of_balance);
        const Eigen::MatrixXd forces = gradients_of(&Actuator::add_gradient);
        const Eigen::VectorXd now = solved_.scaled(state_.multiplier);
        std::optional<Move> move;
        if (!solved_.empty()) move = solve_constrained(gradient, forces, now);
        if (!move) move = solve_by_columns(gradient, forces, now);

        Direction direction{std::move(move->dx), state_.multiplier, 0};
        solved_.add(move->change, direction.multiplier);
        Eigen::VectorXd energy_gradient = gradient;
        for (Eigen::Index k = 0; k < solved_.count(); ++k) {
            if (solved_.all()[static_cast<std::size_t>(k)].drives_measure) energy_gradient -= forces.col(k) * now[k];
        }
        direction.slope_J = energy_gradient.dot(direction.dx);
        return direction;
    }

    [[nodiscard]] Eigen::VectorXd compliances() const {
        return solved_.compliances(controls_.drives, state_.multiplier,
                                   system_.model().description().ambient_pressure_Pa);
    }

    /// One solution for the gradient and one for each solved actuator; then the multipliers that combine them.
    [[nodiscard]] Move solve_by_columns(const Eigen::VectorXd& gradient, const Eigen::MatrixXd& forces,
                                        const Eigen::VectorXd& now) {
        const Eigen::MatrixXd A = by_gaps_ ? gradients_of(&Actuator::add_measure_gradient) : forces;
        Eigen::MatrixXd columns(gradient.size(), 1 + A.cols());
        columns.col(0) = gradient;
        columns.rightCols(A.cols()) = forces;
        curvature_.solve(columns);
        Move move{-columns.col(0), Eigen::VectorXd::Zero(solved_.count())};
        if (solved_.empty()) return move;
        Eigen::MatrixXd S = A.transpose() * columns.rightCols(A.cols());
        // Violation after the unconstrained step; then the correction of the current multipliers.
        const Eigen::VectorXd violation =
            evaluation_.constraint_violation(solved_.actuators()) - A.transpose() * columns.col(0);
        S.diagonal() += compliances();
        move.change = solved_.change(S, violation, now);
        move.dx -= columns.rightCols(A.cols()) * move.change;
        return move;
    }

    /// One solution with all constraints, where the curvature offers that. Cables that turn out to push become slack,
    /// those that turn out too long are pulled, and it is repeated.
    [[nodiscard]] std::optional<Move> solve_constrained(const Eigen::VectorXd& gradient, const Eigen::MatrixXd& forces,
                                                        const Eigen::VectorXd& now) {
        if (by_gaps_ || compliances().any()) return std::nullopt;
        const Eigen::VectorXd violation = evaluation_.constraint_violation(solved_.actuators());
        std::vector<bool> holds = solved_.taut(now, violation);
        for (Eigen::Index round = 0; round < 2 * solved_.count() + 2; ++round) {
            std::vector<Eigen::Index> held;
            Move move{{}, -now};  // slack cables lose their tension
            for (Eigen::Index k = 0; k < solved_.count(); ++k) {
                if (!holds[static_cast<std::size_t>(k)]) continue;
                held.push_back(k);
                move.change[k] = 0;
            }
            if (held.empty()) return std::nullopt;
            auto found = curvature_.solve_constrained(-gradient - forces * move.change, forces(Eigen::all, held),
                                                      -violation(held));
            if (!found) return std::nullopt;
            move.dx = std::move(found->motion);
            move.change(held) = found->multipliers;
            if (solved_.settle(holds, now + move.change, violation + forces.transpose() * move.dx)) return move;
        }
        return std::nullopt;
    }

    bool search(const Direction& direction) {
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(state_.x.size());
        system_.add_free(direction.dx, 1, motion);
        Way way(*this, motion);
        const LineSearch::Path path{way.longest(), curvature_.smallest_share(),
                                    [&](double alpha) { return way.at(alpha); }};
        std::optional<LineSearch::Found> found = search_.search(
            state_, evaluation_, direction, path, [&](const State& next) { return system_.evaluate(next, controls_); });
        if (found) accept(std::move(*found));
        return found.has_value();
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

    void accept(LineSearch::Found found) {
        // The quasi-Newton pair needs both forces at the same multipliers.
        const Eigen::VectorXd old_force =
            solved_.empty() ? evaluation_.out_of_balance : force_at(found.state.multiplier);
        curvature_.learn(system_.restrict_to_free(found.state.x - state_.x),
                         system_.restrict_to_free(found.evaluation.out_of_balance - old_force));
        curvature_.update_convergence(evaluation_.error(), found.evaluation.error());
        state_ = std::move(found.state);
        evaluation_ = std::move(found.evaluation);
        alpha_ = found.alpha;
    }

    /// Out-of-balance force at the current positions with other multipliers.
    [[nodiscard]] Eigen::VectorXd force_at(const Eigen::VectorXd& multiplier) const {
        Eigen::VectorXd force = evaluation_.out_of_balance;
        for (const Eigen::Index a : solved_.actuators()) {
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
    const SolvedActuators solved_;
    LineSearch search_;
    bool by_gaps_ = false;  ///< the force of one of them is not the gradient of its measure
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

}  // namespace

IterationRecord record(Solver solver, int iteration, const Evaluation& e, double alpha) {
    return {.solver = solver,
            .iteration = iteration,
            .residual = e.residual,
            .violation = e.violation,
            .energy_J = e.energy_J,
            .alpha = alpha,
            .min_J = e.min_J};
}

std::string no_convergence(int iterations, double residual) {
    return fmt::format("no convergence in {}, residual {:.2e}",
                       counted(static_cast<std::size_t>(iterations), "iteration"), residual);
}

std::string no_step(Evaluation::Flaw obstacle, double residual) {
    if (obstacle == Evaluation::Flaw::none) return fmt::format("no step lowers the energy, residual {:.2e}", residual);
    return fmt::format("every step that lowers the energy {}, residual {:.2e}", name(obstacle), residual);
}

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
            outcome.reason = no_convergence(limit, residual());
            break;
        }
        ++outcome.iterations;
        if (!solver.iterate(TangentChoice::quickest, settings.tolerance) &&
            !solver.iterate(TangentChoice::exact, settings.tolerance) &&
            !solver.iterate(TangentChoice::projected, settings.tolerance)) {
            outcome.reason = no_step(solver.obstacle(), residual());
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
