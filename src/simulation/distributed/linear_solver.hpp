// The tangent of a robot that is spread over ranks as a matrix of PETSc, and systems with it.
#pragma once

#include <petscksp.h>

#include <Eigen/Core>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/linalg/sparse.hpp"
#include "simulation/distributed/balance.hpp"
#include "simulation/distributed/petsc.hpp"

namespace pliant::sim::distributed {

enum class Preconditioner {
    gamg,  ///< PETSc's algebraic multigrid by smoothed aggregation
    hypre  ///< BoomerAMG
};

/// What solutions have cost so far.
struct LinearWork {
    int matrices = 0, solutions = 0, iterations = 0;
    double assemble_s = 0, set_up_s = 0, solve_s = 0;
};

/// All functions are collective. Conjugate gradients where the tangent is symmetric, else GMRES; what PETSC_OPTIONS
/// says goes before all that is chosen here.
class LinearSolver {
public:
    /// `balance` must outlive it.
    LinearSolver(const Balance& balance, Preconditioner preconditioner);

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
    void lay_out();
    void make_matrix();
    void add_rows(std::span<const double> values, double across, bool skew);
    void hold();
    void set_near_null_space(const Eigen::VectorXd& x);
    void set_options(Preconditioner preconditioner);

    const Balance& balance_;
    linalg::SymmetricPattern pattern_;  ///< over the known nodes, held ones too
    BlockSums sums_;
    /// Rows of the whole matrix, of which the pattern has the lower triangle: (known nodes).
    std::vector<int> row_start_;
    struct Place {
        int slot = 0;    ///< of the pattern
        int column = 0;  ///< known node
        bool transposed = false;
    };
    std::vector<Place> places_;
    std::vector<const Eigen::Matrix3d*> may_move_;  ///< (known nodes), null where a node is free or fixed
    AlignedArray<double> values_;
    double held_stiffness_ = 1;
    Owned<Mat, MatDestroy> matrix_;
    Owned<KSP, KSPDestroy> ksp_;
    Owned<Vec, VecDestroy> right_, solution_;
    bool taken_ = false;        ///< a preconditioner has been made
    int first_iterations_ = 0;  ///< of the first solution with the aggregates at hand
    int last_iterations_ = 0;
    LinearWork work_;
};

}  // namespace pliant::sim::distributed
