// Implicit time stepping: mass and damping as terms of the energy that a step minimises.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/linalg/sparse.hpp"
#include "simulation/parts/robot_names.hpp"

namespace pliant::sim {

class Elements;

/// Where the robot has been: positions and velocities (3n) of the last two steps.
struct History {
    Eigen::VectorXd x, v;
    Eigen::VectorXd x_before, v_before;
    double dt_before = 0;  ///< 0: there is no step before the last
};

/// A symmetric matrix over free nodes. The pattern is the same for all steps.
struct StiffnessMatrix {
    std::shared_ptr<const linalg::SymmetricPattern> pattern;  ///< block 3
    std::vector<double> values;
};

/// The step that leads from a history to x. With steps of one length it is BDF2, else implicit Euler; both only
/// take energy out of a linear system (A-stable; Euler much, BDF2 little). In both v = c (x - p) and a = c (v - q), so
/// that the step's equations are the gradient of  c^2/2 |x - x~|_M^2 + c/2 |x - p|_C^2  with  x~ = p + q / c:
///   Euler  c = 1/h       p = x_n                    q = v_n
///   BDF2   c = 3/(2 h)   p = (4 x_n - x_{n-1})/3    q = (4 v_n - v_{n-1})/3
/// Source: Hairer and Wanner, Solving Ordinary Differential Equations II, chapter III.
class Inertia {
public:
    /// `stiffness` may be null where there is no damping by stiffness; all must outlive the step.
    Inertia(const Elements& elements, const std::vector<int>& free_index, History history, double dt,
            const Damping& damping, std::shared_ptr<const StiffnessMatrix> stiffness);

    [[nodiscard]] double energy(const Eigen::VectorXd& x) const;
    /// forces (3n) += gradient: inertia and damping.
    void add_gradient(const Eigen::VectorXd& x, Eigen::VectorXd& forces) const;
    /// For a pattern (block 3) that holds the elements' cliques; `index` (n) of each node in it, or -1.
    void add_hessian(const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                     std::span<double> values) const;

    /// What the step leads from, and how long it is.
    [[nodiscard]] const History& start() const { return start_; }
    [[nodiscard]] double dt() const { return dt_; }
    /// (3n) what the mass matrix multiplies in the gradient: the acceleration, and damping by mass, m/s^2.
    [[nodiscard]] Eigen::VectorXd acceleration(const Eigen::VectorXd& x) const {
        return rate_ * rate_ * (x - coast_) + rate_ * damping_.mass_per_s * (x - from_);
    }
    /// Velocity (3n) at the end of the step, if it ends at x.
    [[nodiscard]] Eigen::VectorXd velocity(const Eigen::VectorXd& x) const { return rate_ * (x - from_); }
    [[nodiscard]] double rate() const { return rate_; }
    [[nodiscard]] const Damping& damping() const { return damping_; }
    /// (3n) M v, and K v with the stiffness that damping takes (zero without it).
    [[nodiscard]] Eigen::VectorXd mass_times(const Eigen::VectorXd& v) const;
    [[nodiscard]] Eigen::VectorXd stiffness_times(const Eigen::VectorXd& v) const;

    /// (3n) each, by what the step leads from: `force_weights` (3n) times the gradient and `velocity_weights` (3n)
    /// times the velocity, both at a given x. dt_before is not filled in. The stiffness that damping takes stays.
    [[nodiscard]] History start_weights(const Eigen::VectorXd& force_weights,
                                        const Eigen::VectorXd& velocity_weights) const;

    /// The same step from elsewhere, with the stiffness that damping takes here. Force and velocity are linear in x and
    /// the history together: from a change of the history they are what changes.
    [[nodiscard]] Inertia from(History history) const {
        return {*elements_, *free_index_, std::move(history), dt_, damping_, stiffness_};
    }

private:
    [[nodiscard]] Eigen::VectorXd damping_force(const Eigen::VectorXd& motion) const;

    const Elements* elements_;
    const std::vector<int>* free_index_;
    History start_;
    double dt_;
    bool even_ = false;      ///< BDF2
    double rate_ = 0;        ///< c
    Eigen::VectorXd from_;   ///< p
    Eigen::VectorXd coast_;  ///< x~
    Damping damping_;
    std::shared_ptr<const StiffnessMatrix> stiffness_;
};

}  // namespace pliant::sim
