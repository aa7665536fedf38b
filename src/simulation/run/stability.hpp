// Checks whether an equilibrium is stable, or the energy decreases in some direction.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>

#include "base/core/aligned_array.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/solver/equilibrium.hpp"
#include "simulation/solver/tangent_inverse.hpp"
#include "simulation/stepper/robot_state.hpp"

namespace pliant::sim {

/// Finds the softest motion that preserves every prescribed length and volume: the smallest ratio v^T K v / v^T M v,
/// where M is the tangent of the first state or of a later one, by preconditioned conjugate gradients (Knyazev 2001,
/// block size one). The first check takes one factorisation if that state is stable. Later checks start from the
/// previous motion, so that two or three solves with the existing factor are enough; a new factor is made every few
/// checks. If it reports instability, the tangent was negative along a motion. It may overlook a mode that became soft
/// between two checks.
class Stability {
public:
    /// Both must outlive it.
    Stability(const Equilibrium& system, const FactoredLaplacian& laplacian)
        : system_(&system), layout_(laplacian.tangent_layout()), laplacian_(&laplacian) {}

    /// False: the forces have no energy, so that the sign of the tangent has no meaning.
    [[nodiscard]] bool is_applicable() const;

    /// The motion of the free nodes (3 free; scaled to a largest nodal motion of 1) along which the energy of an
    /// equilibrium decreases to second order; empty if none is found. States with contact are not checked.
    [[nodiscard]] std::optional<Eigen::VectorXd> falling_motion(const State& state, const Controls& controls);

private:
    void collect_constraints(const State& state, const Controls& controls);
    [[nodiscard]] bool take_metric(const State& state, const Controls& controls);
    void assemble(const State& state, const Controls& controls, bool project, AlignedArray<double>& values) const;
    [[nodiscard]] Eigen::VectorXd stiffness_times(const Eigen::VectorXd& v) const;
    [[nodiscard]] Eigen::VectorXd metric_times(const Eigen::VectorXd& v) const;
    void solve(Eigen::MatrixXd& columns);
    void keep_constraints(Eigen::VectorXd& v) const;
    void begin();
    void take(const Eigen::VectorXd& v, const Eigen::VectorXd& Mv, const Eigen::VectorXd& Kv);
    [[nodiscard]] bool improve();

    const Equilibrium* system_;
    std::shared_ptr<const TangentLayout> layout_;
    const FactoredLaplacian* laplacian_;
    std::unique_ptr<TangentInverse> inverse_;  ///< of M
    AlignedArray<double> stiffness_, metric_;
    Eigen::MatrixXd fixed_;        ///< (3 free, k) gradients of the prescribed measures
    Eigen::MatrixXd answers_;      ///< M^-1 fixed
    Eigen::MatrixXd gas_;          ///< (3 free, k) gradients of sealed volumes over the square root of their compliance
    Eigen::VectorXd v_, Kv_, Mv_;  ///< the softest motion so far
    Eigen::VectorXd p_, Kp_, Mp_;  ///< its last change
    double ratio_ = 1;
    int age_ = 0;  ///< of the metric, in checks
};

/// True if the path between two equilibria has a jump: bisecting it repeatedly, with `solve` for the equilibrium at a
/// given time from a given state, most of the motion stays in one interval. False also if `solve` fails.
[[nodiscard]] bool is_jump(Moment before, Moment after, const std::function<bool(double time, State& state)>& solve);

}  // namespace pliant::sim
