// The tangent of a robot that is spread over ranks as a matrix of PETSc, and systems with it.
#pragma once

#include <petscksp.h>

#include <Eigen/Core>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "simulation/distributed/balance.hpp"
#include "simulation/distributed/known_pattern.hpp"
#include "simulation/distributed/linear_work.hpp"
#include "simulation/distributed/petsc.hpp"

namespace pliant::sim::distributed {

enum class Preconditioner {
    gamg,  ///< PETSc's algebraic multigrid by smoothed aggregation
    hypre  ///< BoomerAMG
};

/// All functions are collective. Conjugate gradients where the tangent is symmetric, else GMRES; what PETSC_OPTIONS
/// says goes before all that is chosen here.
class LinearSolver {
public:
    /// `balance` and `known` must outlive it.
    LinearSolver(const Balance& balance, const KnownPattern& known, Preconditioner preconditioner);

    /// Takes the tangent of a state, or that of which every part is made positive semi-definite.
    void take(const State& state, bool project);
    /// x (3 owned) <- tangent^-1 b, to `error` of the norm of b. `b` and the result have nothing along what is held.
    /// False: the tangent is not positive definite, or x is no solution for another reason.
    [[nodiscard]] bool solve(const Eigen::VectorXd& b, double error, Eigen::VectorXd& x);
    /// (3 owned) the forces of the tangent at hand, held nodes taking part, for a motion of this rank's known nodes
    /// (3n).
    [[nodiscard]] Eigen::VectorXd forces_of(const Eigen::VectorXd& motion) const;

    [[nodiscard]] const LinearWork& work() const { return work_; }

private:
    void add_rows(Mat matrix, std::span<const double> values, double across, bool skew);
    void hold(Mat matrix);
    void set_near_null_space();
    void make_preconditioner();
    [[nodiscard]] KSPConvergedReason solve_by(KSP ksp, const Eigen::VectorXd& b, double error, Eigen::VectorXd& x);
    void set_options();

    const Balance& balance_;
    const KnownPattern& known_;
    Preconditioner preconditioner_;
    std::vector<const Eigen::Matrix3d*> may_move_;  ///< (known nodes), null where a node is free or fixed
    AlignedArray<double> values_;
    double held_stiffness_ = 1;
    Owned<Mat, MatDestroy> matrix_;
    Owned<KSP, KSPDestroy> ksp_;
    Owned<Vec, VecDestroy> right_, solution_;
    Owned<KSP, KSPDestroy> sturdy_;  ///< GMRES with the same preconditioner, for where conjugate gradients break down
    Eigen::VectorXd places_;         ///< (3 owned) where the matrix at hand was taken
    bool projected_ = false;         ///< it is a projection
    bool aged_ = true;               ///< the aggregates are of an earlier matrix, or there are none
    double first_cost_ = 0;          ///< iterations for each digit of the first solution with the aggregates at hand
    double last_cost_ = 0;
    LinearWork work_;
};

}  // namespace pliant::sim::distributed
