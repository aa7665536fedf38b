// Four ways to turn forces into motion. The step solver asks for H^-1 times a few vectors, where H is
//   local-global   the pre-factored weighted Laplacian: one step is the thesis' local and global step (A.1 to A.4)
//   anderson       the same step, mixed with the last eight so that they cancel as much of it as they can
//   quasi-newton   the same matrix, sharpened by the last ten steps (L-BFGS)
//   newton         the tangent stiffness with the actuators' own stiffness, factorised anew where the last factor, with
//                  the L-BFGS pairs collected since, is no longer expected to be quicker
// so that elements, constraints and line search are the same for all.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "base/linalg/analysis.hpp"
#include "simulation/elements/element_kernels.hpp"
#include "simulation/parts/robot_names.hpp"
#include "simulation/solver/equilibrium.hpp"
#include "simulation/solver/solver_memory.hpp"

namespace pliant::sim {

/// Which tangent a direction is computed with: the one that is quickest, which may be an old factor; the exact tangent
/// of this state, if that makes a difference; or its projection, which is positive definite.
enum class TangentChoice { quickest, exact, projected };

/// Of a state (see Evaluation), and what residual is wanted. All 0: as near to none as can be had.
struct Errors {
    double residual = 0, violation = 0, wanted = 0;
};

class Curvature {
public:
    virtual ~Curvature() = default;
    [[nodiscard]] virtual Solver solver() const = 0;
    [[nodiscard]] virtual int default_iteration_limit() const = 0;
    /// How far a step may be shortened before it counts as no good.
    [[nodiscard]] virtual double smallest_share() const { return 1e-7; }

    /// Called at the start of each step of the program.
    virtual void restart() {}
    /// Called before solve() at a new state, or again where its direction was no good. Both must still be there when
    /// solve() is called. False: no H could be made, or no better one.
    [[nodiscard]] virtual bool refresh(const State& state, const Controls& controls, TangentChoice choice,
                                       Errors errors) = 0;
    /// columns (3 free, k) <- H^-1 columns.
    virtual void solve(Eigen::MatrixXd& columns) = 0;
    /// Retraction: the positions that the direction `motion` (3n) leads to; to first order x + motion.
    [[nodiscard]] virtual Eigen::VectorXd retract(const Eigen::VectorXd& x, const Eigen::VectorXd& motion) const {
        return x + motion;
    }
    /// After an accepted step: how the free nodes moved and how the out-of-balance force changed at fixed
    /// multipliers.
    virtual void learn(const Eigen::VectorXd& step, const Eigen::VectorXd& change) {
        (void)step;
        (void)change;
    }
    /// What it takes along into the next step; null: nothing, each step begins anew.
    [[nodiscard]] virtual std::shared_ptr<const SolverMemory> memory() const { return nullptr; }
    /// Goes on as if `memory` had just been asked for; null: as if new.
    virtual void recall(const SolverMemory* memory) { (void)memory; }
    /// After an accepted step, with the error before it and after it: updates what is known of the rate of convergence.
    virtual void update_convergence(double before, double after) {
        (void)before;
        (void)after;
    }
};

/// The weighted Laplacian of a model, factorised once; shared by the first three and by the prediction of each step.
class FactoredLaplacian {
public:
    explicit FactoredLaplacian(const Equilibrium& system);
    FactoredLaplacian(FactoredLaplacian&&) noexcept;
    ~FactoredLaplacian();
    /// columns (3 free, k) <- L^-1 columns.
    void solve(Eigen::Ref<Eigen::MatrixXd> columns) const;
    /// The positions (3n) that result if the rotations of a step are applied exactly at each integration point (see
    /// RotatingStep) and the Laplacian reconciles the deformation gradients that this gives, as the global step of the
    /// thesis does. Held nodes take their positions from `rotating.end`. After Huang et al. 2011, "Interactive shape
    /// interpolation through controllable dynamic deformation".
    [[nodiscard]] Eigen::VectorXd rotate(const Equilibrium& system, const RotatingStep& rotating) const;
    /// Free motion (3 free) that follows the given motion of all supported nodes (3n) as smoothly as possible.
    [[nodiscard]] Eigen::VectorXd follow(const Equilibrium& system, const Eigen::VectorXd& support_motion) const;

    /// forces (3n) += what holds pieces that nothing else does, a little, and objects: the part of the Laplacian that
    /// is not of the tets, times `motion` (3n).
    void add_hold(const Eigen::VectorXd& motion, Eigen::VectorXd& forces) const;

    /// Of the tangent while nothing touches, and what is known of it: its nodes are coupled as those of the Laplacian.
    [[nodiscard]] const std::shared_ptr<const TangentLayout>& tangent_layout() const;
    [[nodiscard]] const std::shared_ptr<const linalg::Analysis>& analysis() const;
    /// Multiply-adds that its factorisation took.
    [[nodiscard]] double work() const;

private:
    void hold_free_pieces(const Equilibrium& system, const linalg::SymmetricPattern& scalar, std::span<double> values);
    [[nodiscard]] Eigen::VectorXd follow_on_rollers(const Equilibrium& system, const Eigen::VectorXd& forces) const;
    void keep_joined(const Equilibrium& system, const RotatingStep& rotating, Eigen::VectorXd& end) const;
    struct State;
    std::unique_ptr<State> state_;
};

[[nodiscard]] std::unique_ptr<Curvature> make_local_global(const FactoredLaplacian& laplacian);
[[nodiscard]] std::unique_ptr<Curvature> make_anderson(const FactoredLaplacian& laplacian);
[[nodiscard]] std::unique_ptr<Curvature> make_quasi_newton(const FactoredLaplacian& laplacian);
[[nodiscard]] std::unique_ptr<Curvature> make_newton(const Equilibrium& system, const FactoredLaplacian& laplacian);

}  // namespace pliant::sim
