// Is an equilibrium stable, or does the energy fall beside it?
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

/// Looks for the motion along which the tangent is softest among those that keep every length and volume that is
/// driven: the smallest ratio v^T K v / v^T M v, where M is the tangent of the first state or of a later one, by
/// preconditioned conjugate gradients (Knyazev 2001, a block of one). The first look takes one factor if that state is
/// stable. Each later one begins where the last one ended, so that two or three solves with a factor that is there are
/// enough; a new one is made every few looks. What it calls unstable is: the
/// tangent was negative along a motion. It may overlook a mode that got soft between two looks.
class Stability {
public:
    /// Both must outlive it.
    Stability(const Equilibrium& system, const FactoredLaplacian& laplacian)
        : system_(&system), layout_(laplacian.tangent_layout()), laplacian_(&laplacian) {}

    /// False: the forces have no energy, so that the tangent's sign says nothing.
    [[nodiscard]] bool is_applicable() const;

    /// The motion of the free nodes (3 free; the largest of a node is 1) along which the energy of an equilibrium falls
    /// to second order; nothing where none is found. States in which something touches are not judged.
    [[nodiscard]] std::optional<Eigen::VectorXd> falling_motion(const State& state, const Controls& controls);

    /// The smallest ratio at the last look.
    [[nodiscard]] double smallest_ratio() const { return ratio_; }

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
    Eigen::MatrixXd fixed_;        ///< (3 free, k) gradients of what is driven
    Eigen::MatrixXd answers_;      ///< M^-1 fixed
    Eigen::MatrixXd gas_;          ///< (3 free, k) gradients of sealed volumes over the root of their compliance
    Eigen::VectorXd v_, Kv_, Mv_;  ///< the softest motion so far
    Eigen::VectorXd p_, Kp_, Mp_;  ///< and the last change of it
    double ratio_ = 1;
    int age_ = 0;  ///< of the metric, in looks
};

/// True if the way between two equilibria has a jump in it: halved again and again, with `solve` for the equilibrium
/// at a time, from the state that it is given, most of the motion stays in one piece. False also where `solve` fails.
[[nodiscard]] bool is_jump(Moment before, Moment after, const std::function<bool(double time, State& state)>& solve);

}  // namespace pliant::sim
