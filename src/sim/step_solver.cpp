#include "sim/step_solver.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <deque>

#include "sim/elements.hpp"

namespace pliant::sim {
namespace {

/// The excess length may be no larger than this share of the tolerance: the tension follows it closely.
constexpr double excess_share = 0.01;
constexpr double smallest_step = 1e-7;
constexpr std::size_t error_memory = 10;

struct Direction {
    Eigen::VectorXd dx;       ///< (3 free)
    Eigen::VectorXd tension;  ///< (cables) tension that goes with the full step
    double slope_J = 0;       ///< change of energy along dx, to first order
};

/// The tensions t >= 0 that minimise t^T S t / 2 - t^T b: each cable either pulls and keeps its length, or is slack and
/// not too long. S = A^T H^-1 A may be singular (parallel cables). Lawson and Hanson 1974, chapter 23.
Eigen::VectorXd tensions_that_hold(const Eigen::MatrixXd& S, const Eigen::VectorXd& b) {
    const Eigen::Index count = b.size();
    Eigen::VectorXd t = Eigen::VectorXd::Zero(count);
    std::vector<Eigen::Index> pulling;
    const double rounding = 1e-13 * (b.cwiseAbs().maxCoeff() + 1e-300);
    for (Eigen::Index round = 0; round < 3 * count + 3; ++round) {
        const Eigen::VectorXd excess = b - S * t;
        Eigen::Index worst = -1;
        for (Eigen::Index i = 0; i < count; ++i) {
            const bool slack = std::find(pulling.begin(), pulling.end(), i) == pulling.end();
            if (slack && excess[i] > rounding && (worst < 0 || excess[i] > excess[worst])) worst = i;
        }
        if (worst < 0) break;
        pulling.push_back(worst);
        while (!pulling.empty()) {
            const Eigen::MatrixXd small = S(pulling, pulling);
            const Eigen::VectorXd wanted = small.ldlt().solve(b(pulling));
            double share = 1;  // of the way from t to wanted that keeps every tension positive
            for (std::size_t k = 0; k < pulling.size(); ++k) {
                const double from = t[pulling[k]];
                const double to = wanted[static_cast<Eigen::Index>(k)];
                if (to <= 0) share = std::min(share, from / (from - to));
            }
            for (std::size_t k = 0; k < pulling.size(); ++k) {
                t[pulling[k]] += share * (wanted[static_cast<Eigen::Index>(k)] - t[pulling[k]]);
            }
            if (share == 1) break;
            std::erase_if(pulling,
                          [&](Eigen::Index i) { return t[i] <= 1e-14 * t.maxCoeff() ? (t[i] = 0, true) : false; });
        }
    }
    return t;
}

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
            const Eigen::VectorXd excess = excess_of_driven() - A.transpose() * columns.col(0);  // after the free step
            const Eigen::VectorXd change = tensions_that_hold(S, excess + S * tension) - tension;
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
            const bool lower = conservative_ && slope < 0 &&
                               merit.value_J <= start.value_J + 1e-4 * alpha * slope + system_.energy_rounding_J();
            Evaluation evaluation = system_.evaluate(next, controls_);
            const bool nearer = conservative_ ? evaluation.error() < 0.5 * evaluation_.error()
                                              : evaluation.error() < (1 - 1e-3 * alpha) * allowed_error();
            if (!lower && !nearer) continue;
            accept(std::move(next), std::move(evaluation), direction, alpha);
            return true;
        }
        return false;
    }

    /// Without an energy only the error can guide. It is a ratio of forces and rises where a cable begins to pull, so
    /// it may rise for a while: not above the largest of the last steps, nor at first above what any loaded body has
    /// (the non-monotone search of Grippo, Lampariello and Lucidi 1986).
    [[nodiscard]] double allowed_error() const {
        return errors_.size() < error_memory ? 2 : *std::max_element(errors_.begin(), errors_.end());
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
        errors_.push_back(evaluation_.error());
        if (errors_.size() > error_memory) errors_.pop_front();
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
    std::deque<double> errors_;  ///< of the last steps
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
