// The actuators of a step whose multipliers are unknown: those with a prescribed measure, and sealed gas. What a step
// does with them is the same on one machine and on many ranks (simulation/distributed).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

class SolvedActuators {
public:
    struct Constraint {
        Eigen::Index actuator = 0;
        bool only_pulls = false;      ///< a cable: it may be shorter than prescribed
        bool drives_measure = false;  ///< false: sealed gas
        double rest_measure = 0;
    };

    /// `only_pulls` and `rest_measures` are over all actuators.
    SolvedActuators(const std::vector<Drive>& drives, const std::vector<bool>& only_pulls,
                    const std::vector<double>& rest_measures);

    [[nodiscard]] const std::vector<Constraint>& all() const { return all_; }
    [[nodiscard]] const std::vector<Eigen::Index>& actuators() const { return actuators_; }
    [[nodiscard]] Eigen::Index count() const { return static_cast<Eigen::Index>(all_.size()); }
    [[nodiscard]] bool empty() const { return all_.empty(); }

    /// (solved) multipliers times the measures at rest: energies, so that all are comparable.
    [[nodiscard]] Eigen::VectorXd scaled(const Eigen::VectorXd& multiplier) const;
    /// (solved) compliance of sealed gas in the same scale, in addition to that of the body.
    [[nodiscard]] Eigen::VectorXd compliances(const std::vector<Drive>& drives, const Eigen::VectorXd& multiplier,
                                              double ambient_pressure_Pa) const;
    /// Some of them, in ascending order.
    using List = std::vector<Eigen::Index>;
    [[nodiscard]] List list() const;
    /// (some) change of the scaled multipliers that removes the violation of the constraints. `S`: A^T H^-1 A with
    /// the compliances on its diagonal; `violation`: what is left after the unconstrained step.
    [[nodiscard]] Eigen::VectorXd change(const List& some, const Eigen::MatrixXd& S, const Eigen::VectorXd& violation,
                                         const Eigen::VectorXd& scaled_now) const;
    /// (solved) the constraints that are expected to hold as equations: all except cables that are slack and not longer
    /// than prescribed.
    [[nodiscard]] std::vector<bool> taut(const Eigen::VectorXd& scaled_now, const Eigen::VectorXd& violation) const;
    /// True if a cable that is none of `some` is longer than prescribed.
    [[nodiscard]] bool is_too_long_beside(const List& some, const Eigen::VectorXd& violation) const;
    /// Corrects them by what a solution with them leads to: cables that would push go slack, slack ones that would be
    /// too long become taut. True if there were none.
    [[nodiscard]] bool settle(std::vector<bool>& taut, const Eigen::VectorXd& scaled,
                              const Eigen::VectorXd& violation) const;
    /// Adds such a change to the multipliers of all actuators. Cables that would push become slack.
    void add(const Eigen::VectorXd& change, Eigen::VectorXd& multiplier) const;

private:
    std::vector<Constraint> all_;
    std::vector<Eigen::Index> actuators_;
    std::vector<bool> only_pull_;
    Eigen::VectorXd scale_;
};

}  // namespace pliant::sim
