#include "simulation/distributed/newton.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "simulation/solver/line_search.hpp"
#include "simulation/solver/solved_actuators.hpp"

namespace pliant::sim::distributed {
namespace {

constexpr double smallest_alpha = 1e-7;
constexpr int default_iteration_limit = 100;
constexpr double straight_share = 0.05;  // of what is wanted, that a step may spoil by not rotation
constexpr double rotation_error = 1e-3;
/// Errors of linear solutions: a direction need not be better than what is left of the residual after it.
constexpr double largest_solution_error = 1e-3, smallest_solution_error = 1e-11, share_of_wanted = 0.1;

SolvedActuators solved_actuators(const DistributedEquilibrium& system, const Controls& controls) {
    std::vector<bool> only_pulls;
    for (std::size_t a = 0; a < system.actuator_count(); ++a) only_pulls.push_back(system.is_cable(a));
    return {controls.drives, only_pulls, system.rest_measures()};
}

class Newton {
public:
    Newton(const DistributedEquilibrium& system, LinearSolver& linear, StepRotation& rotation, const Controls& controls,
           State& state)
        : system_(system),
          linear_(linear),
          rotation_(rotation),
          controls_(controls),
          state_(state),
          evaluation_(system.evaluate(state, controls)),
          solved_(solved_actuators(system, controls)),
          search_(solved_, system.actuator_count(),
                  {system.conservative(), system.has_skew(), system.energy_rounding_J()}) {
        if (evaluation_.possible()) state_.multiplier = evaluation_.multiplier;
    }

    [[nodiscard]] const Evaluation& evaluation() const { return evaluation_; }
    [[nodiscard]] double alpha() const { return alpha_; }
    [[nodiscard]] Evaluation::Flaw obstacle() const { return search_.obstacle(); }
    [[nodiscard]] bool converged(double tolerance) const { return is_converged(evaluation_, tolerance); }

    /// One iteration, with the tangent or, where that is of no use, with its projection; false if no acceptable step
    /// was found.
    bool iterate(double tolerance) {
        for (const bool project : {false, true}) {
            linear_.set_tangent(state_, project);
            const std::optional<Direction> direction = find_direction(tolerance);
            if (direction && search(*direction, tolerance)) return true;
        }
        return false;
    }

private:
    [[nodiscard]] double solution_error(double tolerance) const {
        const double error = std::max(evaluation_.error(), tolerance);
        const double enough = std::max(std::min(largest_solution_error, error), share_of_wanted * tolerance / error);
        return std::clamp(enough, smallest_solution_error, 0.1);
    }

    /// Without one the tangent was not positive definite.
    [[nodiscard]] std::optional<Direction> find_direction(double tolerance) {
        const double error = solution_error(tolerance);
        Eigen::VectorXd gradient = evaluation_.out_of_balance;
        system_.restrict_to_free(gradient);
        const Eigen::Index count = solved_.count();
        Eigen::MatrixXd forces(gradient.size(), count), motions(gradient.size(), count);
        Eigen::VectorXd column;
        for (Eigen::Index k = 0; k < count; ++k) {
            const Eigen::Index a = solved_.actuators()[static_cast<std::size_t>(k)];
            forces.col(k) = system_.measure_gradient(static_cast<std::size_t>(a), state_.x);
            if (!linear_.solve(forces.col(k), error, column)) return std::nullopt;
            motions.col(k) = column;
        }
        if (!linear_.solve(gradient, error, column)) return std::nullopt;
        Direction direction{-column, state_.multiplier, 0};
        Eigen::VectorXd energy_gradient = gradient;
        if (count > 0) hold_constraints(forces, motions, direction, energy_gradient);
        direction.slope_J = system_.nodes().dot(energy_gradient, direction.dx);
        if (!std::isfinite(direction.slope_J)) return std::nullopt;
        return direction;
    }

    /// The multipliers of the full step, and what they add to it.
    void hold_constraints(const Eigen::MatrixXd& forces, const Eigen::MatrixXd& motions, Direction& direction,
                          Eigen::VectorXd& energy_gradient) {
        const Eigen::Index count = solved_.count();
        Eigen::MatrixXd products(count, count + 1);
        products.leftCols(count) = forces.transpose() * motions;
        products.col(count) = forces.transpose() * direction.dx;
        system_.ranks().add_up({products.data(), static_cast<std::size_t>(products.size())});
        Eigen::MatrixXd S = products.leftCols(count);
        S.diagonal() += solved_.compliances(controls_.drives, state_.multiplier, system_.part().ambient_pressure_Pa);
        const Eigen::VectorXd now = solved_.scaled(state_.multiplier);
        const Eigen::VectorXd violation = evaluation_.constraint_violation(solved_.actuators()) + products.col(count);
        const Eigen::VectorXd change = solved_.change(solved_.list(), S, violation, now);
        direction.dx -= motions * change;
        solved_.add(change, direction.multiplier);
        for (Eigen::Index k = 0; k < count; ++k)
            if (solved_.all()[static_cast<std::size_t>(k)].drives_measure) energy_gradient -= forces.col(k) * now[k];
    }

    bool search(const Direction& direction, double tolerance) {
        const Eigen::VectorXd motion = system_.nodes().with_ghosts(direction.dx);
        const bool straight = evaluation_.error() * evaluation_.error() < straight_share * tolerance;
        const auto at = [&](double alpha) {
            Eigen::VectorXd end = state_.x + alpha * motion;
            if (straight) return end;
            return rotation_.rotate({.now = state_.x.data(), .end = end.data()}, rotation_error);
        };
        const auto evaluate = [&](const State& next) { return system_.evaluate(next, controls_); };
        std::optional<LineSearch::Found> found =
            search_.search(state_, evaluation_, direction, {1, smallest_alpha, at}, evaluate);
        if (!found) return false;
        state_ = std::move(found->state);
        evaluation_ = std::move(found->evaluation);
        alpha_ = found->alpha;
        return true;
    }

    const DistributedEquilibrium& system_;
    LinearSolver& linear_;
    StepRotation& rotation_;
    const Controls& controls_;
    State& state_;
    Evaluation evaluation_;
    double alpha_ = 0;
    const SolvedActuators solved_;
    LineSearch search_;
};

}  // namespace

StepOutcome solve_step(const DistributedEquilibrium& system, LinearSolver& linear, StepRotation& rotation,
                       const Controls& controls, const StepSettings& settings, State& state) {
    Newton newton(system, linear, rotation, controls, state);
    StepOutcome outcome;
    outcome.solver = Solver::newton;
    outcome.history.push_back(record(Solver::newton, 0, newton.evaluation(), 0));
    const int limit = settings.iteration_limit > 0 ? settings.iteration_limit : default_iteration_limit;
    while (!(outcome.converged = newton.converged(settings.tolerance))) {
        const double residual = newton.evaluation().residual;
        if (outcome.iterations == limit) {
            outcome.reason = no_convergence(limit, residual);
            break;
        }
        ++outcome.iterations;
        if (!newton.iterate(settings.tolerance)) {
            outcome.reason = no_step(newton.obstacle(), residual);
            break;
        }
        outcome.history.push_back(record(Solver::newton, outcome.iterations, newton.evaluation(), newton.alpha()));
    }
    outcome.evaluation = newton.evaluation();
    return outcome;
}

}  // namespace pliant::sim::distributed
