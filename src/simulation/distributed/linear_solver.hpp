// The tangent of a distributed robot as a PETSc matrix, and the solution of linear systems with it.
#pragma once

#include <petscksp.h>

#include <Eigen/Core>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "simulation/distributed/distributed_equilibrium.hpp"
#include "simulation/distributed/linear_work.hpp"
#include "simulation/distributed/local_pattern.hpp"
#include "simulation/distributed/petsc.hpp"

namespace pliant::sim::distributed {

enum class Preconditioner {
    gamg,  ///< PETSc's algebraic multigrid by smoothed aggregation
    hypre  ///< BoomerAMG
};

/// Conjugate gradients if the tangent is symmetric, else GMRES. PETSC_OPTIONS takes precedence over all choices here.
/// All functions are collective.
class LinearSolver {
public:
    /// `system` and `local` must outlive it.
    LinearSolver(const DistributedEquilibrium& system, const LocalPattern& local, Preconditioner preconditioner);

    /// Assembles the tangent of a state or, with `project`, the sum of its positive semi-definite parts.
    void set_tangent(const State& state, bool project);
    /// x (3 owned) <- tangent^-1 b, with a residual of `error` times the norm of b. `b` and x have no components along
    /// held directions. False: the tangent is not positive definite, or the solver failed for another reason.
    [[nodiscard]] bool solve(const Eigen::VectorXd& b, double error, Eigen::VectorXd& x);
    /// (3 owned) the current tangent, including held nodes, times a motion of the local nodes (3n).
    [[nodiscard]] Eigen::VectorXd forces_of(const Eigen::VectorXd& motion) const;

    [[nodiscard]] const LinearWork& work() const { return work_; }

private:
    void add_rows(Mat matrix, std::span<const double> values, double across, bool skew);
    void hold(Mat matrix);
    void set_near_null_space();
    void make_preconditioner();
    [[nodiscard]] KSPConvergedReason solve_by(KSP ksp, const Eigen::VectorXd& b, double error, Eigen::VectorXd& x);
    void set_options();

    const DistributedEquilibrium& system_;
    const LocalPattern& local_;
    Preconditioner preconditioner_;
    std::vector<const Eigen::Matrix3d*> may_move_;  ///< (local nodes) of rollers, else null
    AlignedArray<double> values_;
    double held_stiffness_ = 1;
    Owned<Mat, MatDestroy> matrix_;
    Owned<KSP, KSPDestroy> ksp_;
    Owned<Vec, VecDestroy> right_, solution_;
    Owned<KSP, KSPDestroy> gmres_;  ///< with the same preconditioner, if conjugate gradients break down
    Eigen::VectorXd places_;        ///< (3 owned) positions of the current matrix
    bool projected_ = false;        ///< the current matrix is a projection
    bool reused_ = true;            ///< the preconditioner is that of an earlier matrix
    double first_cost_ = 0;         ///< iterations per digit of the first solution with the current preconditioner
    double last_cost_ = 0;
    LinearWork work_;
};

}  // namespace pliant::sim::distributed
