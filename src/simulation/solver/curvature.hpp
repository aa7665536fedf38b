// Four approximations H of the stiffness. The step solver asks for H^-1 times a few vectors, where H is
//   local-global   the pre-factored weighted Laplacian: one step is the thesis' local and global step (A.1 to A.4)
//   anderson       the same step, combined with the last eight to minimise the residual (Anderson mixing)
//   quasi-newton   the same matrix, updated with the last ten steps (L-BFGS)
//   newton         the tangent stiffness including that of the actuators, factorised again when the last factor, with
//                  the L-BFGS pairs collected since, is no longer expected to be faster
//
// so that elements, constraints and line search are shared by all.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/linalg/cholesky.hpp"
#include "simulation/elements/element_kernels.hpp"
#include "simulation/parts/robot_names.hpp"
#include "simulation/solver/equilibrium.hpp"
#include "simulation/solver/solver_memory.hpp"

namespace pliant::sim {

/// Which tangent a direction is computed with: the fastest, which may be an old factor; the exact tangent of this
/// state, if it differs; or its projection, which is positive definite.
enum class TangentChoice { quickest, exact, projected };

/// Errors of a state (see Evaluation), and the target residual. All 0: as accurate as possible.
struct Errors {
    double residual = 0, violation = 0, wanted = 0;
};

class Curvature {
public:
    virtual ~Curvature() = default;
    [[nodiscard]] virtual Solver solver() const = 0;
    [[nodiscard]] virtual int default_iteration_limit() const = 0;
    /// Smallest step length that still counts as progress.
    [[nodiscard]] virtual double smallest_share() const { return 1e-7; }

    /// Called at the start of each step of the program.
    virtual void restart() {}
    /// Called before solve() at a new state, or again if its direction was rejected. Both arguments must be valid until
    /// solve() is called. False: H could not be computed, or not improved.
    [[nodiscard]] virtual bool refresh(const State& state, const Controls& controls, TangentChoice choice,
                                       Errors errors) = 0;
    /// columns (3 free, k) <- H^-1 columns.
    virtual void solve(Eigen::MatrixXd& columns) = 0;
    /// How the body yields to the forces B (3 free, k) of constraints, where H was made.
    struct Yielding {
        Eigen::MatrixXd motions;     ///< (3 free, k) H^-1 B
        Eigen::MatrixXd compliance;  ///< (k, k) B^T H^-1 B
    };
    /// Of some actuators, on the free nodes: (3 free, actuators) at the positions `x` (3n).
    struct Forces {
        const std::vector<Eigen::Index>& actuators;
        std::function<Eigen::MatrixXd(const Eigen::VectorXd& x, const Controls& controls)> at;
    };
    /// The same for all states at which this H is used, since it only serves to find the multipliers: then the forces
    /// are those at the state at which H was made. Called after solve(). Null: solve for the forces at each state.
    [[nodiscard]] virtual const Yielding* yielding_to(const Forces& forces) {
        (void)forces;
        return nullptr;
    }
    /// A motion (3 free) at the state at which H was made, as one of the present state.
    [[nodiscard]] virtual Eigen::VectorXd push_forward(const Eigen::VectorXd& motion) const { return motion; }
    /// Motion and multipliers with H motion + normals multipliers = force and normals^T motion = wanted, for all
    /// constraints at once: one system instead of one each. Empty: only solve() can do it.
    struct Constrained {
        Eigen::VectorXd motion, multipliers;
    };
    [[nodiscard]] virtual std::optional<Constrained> solve_constrained(const Eigen::VectorXd& force,
                                                                       const Eigen::MatrixXd& normals,
                                                                       const Eigen::VectorXd& wanted) {
        (void)force, (void)normals, (void)wanted;
        return std::nullopt;
    }
    /// The factor, over the free nodes, of the tangent of everything except contact and friction, at the state of the
    /// last refresh(); valid until the next. Null: there is none, or it would take too long.
    [[nodiscard]] virtual const linalg::Cholesky* factor_without_contact() { return nullptr; }
    /// Retraction: the positions reached along the direction `motion` (3n); x + motion to first order.
    [[nodiscard]] virtual Eigen::VectorXd retract(const Eigen::VectorXd& x, const Eigen::VectorXd& motion) const {
        return x + motion;
    }
    /// Called after an accepted step, with the motion of the free nodes and the change of the out-of-balance force at
    /// fixed multipliers.
    virtual void learn(const Eigen::VectorXd& step, const Eigen::VectorXd& change) {
        (void)step;
        (void)change;
    }
    /// State to carry over into the next step; null: nothing, each step starts anew.
    [[nodiscard]] virtual std::shared_ptr<const SolverMemory> memory() const { return nullptr; }
    /// Restores such a state; null: as if new.
    virtual void recall(const SolverMemory* memory) { (void)memory; }
    /// Called after an accepted step with the error before and after it: updates the estimated rate of convergence.
    virtual void update_convergence(double before, double after) {
        (void)before;
        (void)after;
    }
};

/// The weighted Laplacian of a model, factorised once or, where the factor would be too large, solved on several
/// levels; shared by the first three and by the predictor of each step.
class FactoredLaplacian {
public:
    /// No factor of more than about `most_entries` is made: up to 4e7, it solves faster than levels do; from there on,
    /// they take a quarter of the memory, and are set up in a tenth of the time.
    explicit FactoredLaplacian(const Equilibrium& system, double most_entries = 4e7);
    FactoredLaplacian(FactoredLaplacian&&) noexcept;
    ~FactoredLaplacian();
    /// columns (3 free, k) <- L^-1 columns.
    void solve(Eigen::Ref<Eigen::MatrixXd> columns) const;
    /// The positions (3n) that result if the rotations of a step are applied exactly at each integration point (see
    /// RotatingStep) and the resulting deformation gradients are made compatible by the Laplacian, like the global step
    /// of the thesis. Held nodes take their positions from `rotating.end`. After Huang et al. 2011, "Interactive shape
    /// interpolation through controllable dynamic deformation".
    [[nodiscard]] Eigen::VectorXd rotate(const Equilibrium& system, const RotatingStep& rotating) const;
    /// Smoothest free motion (3 free) for the given motion of all supported nodes (3n).
    [[nodiscard]] Eigen::VectorXd follow(const Equilibrium& system, const Eigen::VectorXd& support_motion) const;

    /// forces (3n) += the part of the Laplacian that does not come from tets, times `motion` (3n): a weak hold of free
    /// pieces, and the stiffness of objects.
    void add_hold(const Eigen::VectorXd& motion, Eigen::VectorXd& forces) const;

    /// Layout and, computed on demand, analysis of the tangent without contact: its nodes are coupled like those of the
    /// Laplacian.
    [[nodiscard]] const std::shared_ptr<const TangentLayout>& tangent_layout() const;
    [[nodiscard]] const std::shared_ptr<const linalg::Analysis>& analysis() const;
    /// Number of multiply-adds of its factorisation, estimated where there is none.
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
