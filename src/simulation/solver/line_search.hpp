// The line search of a step, on one machine and on many ranks (simulation/distributed): which state on the path of a
// direction is accepted.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <functional>
#include <optional>

#include "simulation/solver/equilibrium.hpp"
#include "simulation/solver/solved_actuators.hpp"

namespace pliant::sim {

struct Direction {
    Eigen::VectorXd dx;          ///< motion of the free nodes
    Eigen::VectorXd multiplier;  ///< (actuators) for the full step
    double slope_J = 0;          ///< change of energy along dx, to first order
};

/// The constraint violation must be below this share of the tolerance, because the tension is sensitive to it.
[[nodiscard]] bool constraints_hold(const Evaluation& evaluation, double tolerance);
[[nodiscard]] bool is_converged(const Evaluation& evaluation, double tolerance);

/// The search of one step of the program: it remembers the penalties of the constraints and the last errors.
class LineSearch {
public:
    struct Forces {
        bool conservative = true;      ///< all of them are the gradient of one energy
        bool skew_in_tangent = false;  ///< directions take the skew part of the tangent into account
        double energy_rounding_J = 0;  ///< energies that differ by less are equal
    };
    /// `solved` must outlive it. `actuators`: of the model.
    LineSearch(const SolvedActuators& solved, std::size_t actuators, const Forces& forces);

    struct Path {
        double longest = 1;   ///< the first step length
        double shortest = 0;  ///< steps that are not longer than this are no progress
        /// Positions at a step length, which decreases from call to call.
        std::function<Eigen::VectorXd(double)> at;
    };
    struct Found {
        State state;
        Evaluation evaluation;
        double alpha = 0;
    };
    /// Halves the step until the state is possible and the merit (or the error) decreases. `evaluation`: of `from`.
    [[nodiscard]] std::optional<Found> search(const State& from, const Evaluation& evaluation,
                                              const Direction& direction, const Path& path,
                                              const std::function<Evaluation(const State&)>& evaluate);
    /// Flaw of the shortest step tried last; none: it is possible, but no improvement.
    [[nodiscard]] Evaluation::Flaw obstacle() const { return obstacle_; }

private:
    void raise_penalty_weights(const Eigen::VectorXd& multiplier);
    [[nodiscard]] double constraint_penalty(const Evaluation& evaluation) const;
    [[nodiscard]] double allowed_error(double error_now) const;

    const SolvedActuators& solved_;
    Forces forces_;
    Eigen::VectorXd penalty_weights_;  ///< (actuators)
    std::deque<double> errors_;        ///< of the last steps
    Evaluation::Flaw obstacle_ = Evaluation::Flaw::none;
};

}  // namespace pliant::sim
