#include "sim/step_solver.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "sim/elements.hpp"

namespace pliant::sim {
namespace {

/// The excess length may be no larger than this share of the tolerance: the tension follows it closely.
constexpr double excess_share = 0.01;
constexpr double smallest_step = 1e-7;

struct Direction {
    Eigen::VectorXd dx;       ///< (3 free)
    Eigen::VectorXd tension;  ///< (cables) tension that goes with the full step
    double slope_J = 0;       ///< change of energy along dx, to first order
};

class StepSolver {
public:
    StepSolver(const Equilibrium& system, Curvature& curvature, const Controls& controls, State& state)
        : system_(system), curvature_(curvature), controls_(controls), state_(state) {
        for (std::size_t c = 0; c < controls.cable_length_m.size(); ++c) {
            if (std::isfinite(controls.cable_length_m[c]))
                driven_.push_back(static_cast<Eigen::Index>(c));
            else
                state_.tension[static_cast<Eigen::Index>(c)] = controls.cable_tension_N[c];
        }
        conservative_ = system.model().elements().has_energy();
        evaluation_ = system.evaluate(state, controls);
    }

    [[nodiscard]] const Evaluation& evaluation() const { return evaluation_; }
    [[nodiscard]] bool converged(double tolerance) const {
        return evaluation_.residual <= tolerance && evaluation_.excess <= excess_share * tolerance;
    }

    /// One iteration; false if no acceptable step was found.
    bool iterate(bool cautious) {
        if (!curvature_.refresh(state_, cautious)) return false;
        const Direction direction = find_direction();
        if (!direction.dx.allFinite()) return false;
        return search(direction);
    }

private:
    /// dL/dx of every cable driven by length, on free nodes: (3 free, driven).
    [[nodiscard]] Eigen::MatrixXd constraint_gradients() const {
        Eigen::MatrixXd gradients(3 * system_.model().free_count(), static_cast<Eigen::Index>(driven_.size()));
        for (std::size_t k = 0; k < driven_.size(); ++k) {
            Eigen::VectorXd full = Eigen::VectorXd::Zero(state_.x.size());
            system_.cables()[static_cast<std::size_t>(driven_[k])].add_gradient(
                {state_.x.data(), static_cast<std::size_t>(state_.x.size())}, 1.0,
                {full.data(), static_cast<std::size_t>(full.size())});
            gradients.col(static_cast<Eigen::Index>(k)) = system_.restrict_to_free(full);
        }
        return gradients;
    }

    [[nodiscard]] Eigen::VectorXd excess_of_driven() const {
        Eigen::VectorXd excess(static_cast<Eigen::Index>(driven_.size()));
        for (std::size_t k = 0; k < driven_.size(); ++k) {
            excess[static_cast<Eigen::Index>(k)] = evaluation_.excess_m[static_cast<std::size_t>(driven_[k])];
        }
        return excess;
    }

    /// The change of tensions that keeps the linearised lengths, with slack cables let go: a primal active-set loop on
    /// the small matrix S = A^T H^-1 A.
    [[nodiscard]] Eigen::VectorXd active_tension_change(const Eigen::MatrixXd& S, const Eigen::VectorXd& wanted,
                                                        const Eigen::VectorXd& tension) const {
        const Eigen::Index k = wanted.size();
        std::vector<bool> active(static_cast<std::size_t>(k), true);
        Eigen::VectorXd change = -tension;
        for (Eigen::Index round = 0; round <= 2 * k; ++round) {
            std::vector<Eigen::Index> list;
            for (Eigen::Index i = 0; i < k; ++i) {
                if (active[static_cast<std::size_t>(i)]) list.push_back(i);
            }
            change = -tension;
            if (!list.empty()) {
                const Eigen::VectorXd rest = wanted + S * tension;
                const Eigen::MatrixXd small = S(list, list);
                const Eigen::VectorXd total = small.ldlt().solve(rest(list));  // tension itself, not its change
                for (std::size_t i = 0; i < list.size(); ++i)
                    change[list[i]] = total[static_cast<Eigen::Index>(i)] - tension[list[i]];
            }
            const Eigen::VectorXd result = tension + change;
            const Eigen::VectorXd left = wanted - S * change;  // excess that remains after the step
            bool settled = true;
            for (Eigen::Index i = 0; i < k; ++i) {
                const bool on = active[static_cast<std::size_t>(i)];
                if (on && result[i] < 0)
                    active[static_cast<std::size_t>(i)] = settled = false;
                else if (!on && left[i] > 1e-12)
                    active[static_cast<std::size_t>(i)] = true, settled = false;
                if (!settled) break;  // one change at a time keeps the loop finite
            }
            if (settled) break;
        }
        return change;
    }

    [[nodiscard]] Direction find_direction() {
        const Eigen::VectorXd gradient = system_.restrict_to_free(evaluation_.out_of_balance);
        const Eigen::MatrixXd A = constraint_gradients();
        Eigen::MatrixXd columns(gradient.size(), 1 + A.cols());
        columns.col(0) = gradient;
        columns.rightCols(A.cols()) = A;
        curvature_.solve(columns);

        Direction direction;
        direction.tension = state_.tension;
        direction.dx = -columns.col(0);
        Eigen::VectorXd energy_gradient = gradient;
        if (!driven_.empty()) {
            const Eigen::VectorXd tension = state_.tension(driven_);
            const Eigen::MatrixXd S = A.transpose() * columns.rightCols(A.cols());
            const Eigen::VectorXd wanted = excess_of_driven() - A.transpose() * columns.col(0);
            const Eigen::VectorXd change = active_tension_change(S, wanted, tension);
            direction.dx -= columns.rightCols(A.cols()) * change;
            direction.tension(driven_) += change;
            direction.tension = direction.tension.cwiseMax(0.0);
            energy_gradient -= A * tension;
        }
        direction.slope_J = energy_gradient.dot(direction.dx);
        return direction;
    }

    /// Halves the step until min_J stays positive and the merit (or the error) goes down.
    bool search(const Direction& direction) {
        const double price = price_of_excess(direction);
        const Equilibrium::Merit start = system_.merit(state_.x, controls_, price);
        double violated = 0;
        for (const Eigen::Index c : driven_)
            violated += std::max(evaluation_.excess_m[static_cast<std::size_t>(c)], 0.0);
        const double slope = direction.slope_J - price * violated;
        for (double alpha = 1; alpha > smallest_step; alpha *= 0.5) {
            State next = state_;
            system_.add_free(direction.dx, alpha, next.x);
            next.tension += alpha * (direction.tension - state_.tension);
            const Equilibrium::Merit merit = system_.merit(next.x, controls_, price);
            if (!(merit.min_J > 0.05 * evaluation_.min_J)) continue;
            const double rounding = 1e-14 * (std::fabs(start.value_J) + std::fabs(merit.value_J));
            const bool lower =
                conservative_ && slope < 0 && merit.value_J <= start.value_J + 1e-4 * alpha * slope + rounding;
            Evaluation evaluation = system_.evaluate(next, controls_);
            const bool nearer = evaluation.error() < (conservative_ ? 0.5 : 1 - 1e-3 * alpha) * evaluation_.error();
            if (!lower && !nearer) continue;
            accept(std::move(next), std::move(evaluation), direction, alpha);
            return true;
        }
        return false;
    }

    /// A metre of excess must cost more than any tension that holds it, or the merit would prefer long cables.
    [[nodiscard]] double price_of_excess(const Direction& direction) {
        for (const Eigen::Index c : driven_) price_ = std::max(price_, 2 * direction.tension[c]);
        return price_;
    }

    void accept(State next, Evaluation evaluation, const Direction& direction, double alpha) {
        // The quasi-Newton pair needs both forces at the same tension.
        State before = state_;
        before.tension = next.tension;
        const Eigen::VectorXd old_force = driven_.empty() ? evaluation_.out_of_balance : force_at(before);
        curvature_.learn(alpha * direction.dx, system_.restrict_to_free(evaluation.out_of_balance - old_force));
        state_ = std::move(next);
        evaluation_ = std::move(evaluation);
    }

    /// Out-of-balance force of the present positions at other tensions: only the cables' part changes.
    [[nodiscard]] Eigen::VectorXd force_at(const State& state) const {
        Eigen::VectorXd force = evaluation_.out_of_balance;
        for (const Eigen::Index c : driven_) {
            system_.cables()[static_cast<std::size_t>(c)].add_gradient(
                {state.x.data(), static_cast<std::size_t>(state.x.size())}, state.tension[c] - state_.tension[c],
                {force.data(), static_cast<std::size_t>(force.size())});
        }
        return force;
    }

    const Equilibrium& system_;
    Curvature& curvature_;
    const Controls& controls_;
    State& state_;
    Evaluation evaluation_;
    std::vector<Eigen::Index> driven_;  ///< cables driven by length
    bool conservative_ = true;
    double price_ = 0;
};

}  // namespace

StepOutcome solve_step(const Equilibrium& system, Curvature& curvature, const Controls& controls,
                       const StepSettings& settings, State& state, const Progress& progress) {
    StepSolver solver(system, curvature, controls, state);
    StepOutcome outcome;
    const int limit = settings.iteration_limit > 0 ? settings.iteration_limit : curvature.default_iteration_limit();
    while (!(outcome.converged = solver.converged(settings.tolerance))) {
        if (progress.cancelled()) {
            outcome.reason = "cancelled";
            break;
        }
        if (outcome.iterations == limit) {
            outcome.reason =
                fmt::format("no convergence in {} iterations, residual {:.2e}", limit, solver.evaluation().residual);
            break;
        }
        ++outcome.iterations;
        if (!solver.iterate(false) && !solver.iterate(true)) {
            outcome.reason =
                fmt::format("no step lowers the energy without turning a tetrahedron inside out, residual {:.2e}",
                            solver.evaluation().residual);
            break;
        }
    }
    outcome.evaluation = solver.evaluation();
    return outcome;
}

}  // namespace pliant::sim
