#include "simulation/distributed/linear_solver.hpp"

#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "base/core/stopwatch.hpp"
#include "base/linalg/vectors.hpp"

namespace pliant::sim::distributed {
namespace {

using linalg::view;
using RowBlock = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int most_iterations = 2000, restart = 100;
/// A preconditioner is reused, for later tangents too, while solutions take at most this many times the iterations of
/// the first one: to set up another costs as much as some thirty iterations.
constexpr double largest_growth = 1.5;
constexpr double allowance = 3;  // further iterations per digit

/// Nodes that are coupled more weakly than this do not join an aggregate: two thirds to one half of the iterations.
constexpr double coupling_threshold = 0.02;

}  // namespace

LinearSolver::LinearSolver(const DistributedEquilibrium& system, const LocalPattern& local,
                           Preconditioner preconditioner)
    : system_(system), local_(local), preconditioner_(preconditioner) {
    const Whole& whole = system.share().whole;
    held_stiffness_ = whole.stiffest_Pa * std::cbrt(whole.volume_m3 / whole.tets);
    may_move_.assign(system.all_nodes().size(), nullptr);
    for (const DistributedEquilibrium::Roller& roller : system.rollers())
        may_move_[static_cast<std::size_t>(roller.node)] = &roller.may_move;
    values_.resize(local.pattern.entries());
    parallel_clear(values_.span());
    matrix_ = make_matrix(system, 3, [&](Mat matrix) {
        add_rows(matrix, values_.span(), 1, false);
        hold(matrix);
    });
    must(MatSetOption(matrix_.get(), MAT_SYMMETRIC, system.has_skew() ? PETSC_FALSE : PETSC_TRUE));
    const auto own = static_cast<PetscInt>(system.nodes().owned());
    must(VecCreateMPIWithArray(system.ranks().comm(), 3, own, PETSC_DECIDE, nullptr, right_.fill()));
    must(VecCreateMPIWithArray(system.ranks().comm(), 3, own, PETSC_DECIDE, nullptr, solution_.fill()));
}

/// Adds the blocks of the lower triangle, and their transposes times `across` above it.
void LinearSolver::add_rows(Mat matrix, std::span<const double> values, double across, bool skew) {
    const std::vector<int>& number = system_.share().number;
    RowBlock row;
    std::vector<PetscInt> columns;
    for (std::size_t i = 0; i + 1 < local_.row_start.size(); ++i) {
        const auto first = static_cast<std::size_t>(local_.row_start[i]),
                   end = static_cast<std::size_t>(local_.row_start[i + 1]);
        if (first == end) continue;
        row.resize(3, 3 * static_cast<Eigen::Index>(end - first));
        columns.clear();
        for (std::size_t k = first; k < end; ++k) {
            const LocalPattern::Place& place = local_.places[k];
            Eigen::Matrix3d block =
                Eigen::Map<const Eigen::Matrix3d>(values.data() + 9 * static_cast<std::size_t>(place.slot));
            // Of the blocks on the diagonal the lower triangle counts.
            if (place.column == static_cast<int>(i) && !skew) block = block.selfadjointView<Eigen::Lower>();
            if (place.transposed) block = (across * block.transpose()).eval();
            if (may_move_[i] != nullptr) block = (*may_move_[i] * block).eval();
            if (const auto* free = may_move_[static_cast<std::size_t>(place.column)]) block = (block * *free).eval();
            row.middleCols<3>(3 * static_cast<Eigen::Index>(k - first)) = block;
            columns.push_back(number[static_cast<std::size_t>(place.column)]);
        }
        const PetscInt own = number[i];
        must(MatSetValuesBlocked(matrix, 1, &own, static_cast<PetscInt>(columns.size()), columns.data(), row.data(),
                                 ADD_VALUES));
    }
}

/// What is held has a stiffness of its own, coupled to nothing.
void LinearSolver::hold(Mat matrix) {
    const Share& share = system_.share();
    const auto add = [&](int node, const Eigen::Matrix3d& held) {
        const Eigen::Matrix3d block = held_stiffness_ * held;  // symmetric: by rows or by columns
        const PetscInt own = share.number[static_cast<std::size_t>(node)];
        must(MatSetValuesBlocked(matrix, 1, &own, 1, &own, block.data(), ADD_VALUES));
    };
    for (int node = 0; node < share.owned; ++node)
        if (share.fixed[static_cast<std::size_t>(node)] != 0) add(node, Eigen::Matrix3d::Identity());
    for (const DistributedEquilibrium::Roller& roller : system_.rollers())
        if (roller.node < share.owned) add(roller.node, Eigen::Matrix3d::Identity() - roller.may_move);
}

/// The rigid motions of the deformed body, which the coarse levels must represent.
void LinearSolver::set_near_null_space() {
    Owned<Vec, VecDestroy> places;
    must(VecCreateMPI(system_.ranks().comm(), static_cast<PetscInt>(system_.nodes().owned()), PETSC_DETERMINE,
                      places.fill()));
    must(VecSetBlockSize(places.get(), 3));
    double* array = nullptr;
    must(VecGetArray(places.get(), &array));
    std::copy_n(places_.data(), places_.size(), array);
    must(VecRestoreArray(places.get(), &array));
    Owned<MatNullSpace, MatNullSpaceDestroy> motions;
    must(MatNullSpaceCreateRigidBody(places.get(), motions.fill()));
    must(MatSetNearNullSpace(matrix_.get(), motions.get()));
}

void LinearSolver::set_options() {
    must(KSPCreate(system_.ranks().comm(), ksp_.fill()));
    KSP ksp = ksp_.get();
    must(KSPSetType(ksp, system_.has_skew() ? KSPGMRES : KSPCG));
    if (system_.has_skew()) {
        must(KSPSetPCSide(ksp, PC_RIGHT));
        must(KSPGMRESSetRestart(ksp, restart));
    }
    must(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
    must(KSPSetInitialGuessNonzero(ksp, PETSC_FALSE));
    PC pc = nullptr;
    must(KSPGetPC(ksp, &pc));
    must(PCSetType(pc, preconditioner_ == Preconditioner::gamg ? PCGAMG : PCHYPRE));
    if (preconditioner_ == Preconditioner::gamg) {
        must(PCGAMGSetType(pc, PCGAMGAGG));
        must(PCGAMGSetNSmooths(pc, 1));
        double threshold = coupling_threshold;
        must(PCGAMGSetThreshold(pc, &threshold, 1));
    } else {
        must(PCHYPRESetType(pc, "boomeramg"));
    }
    must(KSPSetFromOptions(ksp));
    must(KSPCreate(system_.ranks().comm(), gmres_.fill()));
    must(KSPSetPC(gmres_.get(), pc));
    must(KSPSetType(gmres_.get(), KSPGMRES));
    must(KSPSetPCSide(gmres_.get(), PC_RIGHT));
    must(KSPGMRESSetRestart(gmres_.get(), restart));
    must(KSPSetOperators(gmres_.get(), matrix_.get(), matrix_.get()));
}

void LinearSolver::set_tangent(const State& state, bool project) {
    Stopwatch watch;
    const LogStage stage("set up tangents");
    must(MatZeroEntries(matrix_.get()));
    parallel_clear(values_.span());
    system_.add_tangent(state, local_.pattern, local_.sums, values_.span(), project);
    add_rows(matrix_.get(), values_.span(), 1, false);
    if (system_.has_skew() && !project) {
        std::vector<double> skew(values_.size(), 0.0);
        system_.add_skew(state, local_.pattern, skew);
        add_rows(matrix_.get(), skew, -1, true);
    }
    hold(matrix_.get());
    must(MatAssemblyBegin(matrix_.get(), MAT_FINAL_ASSEMBLY));
    must(MatAssemblyEnd(matrix_.get(), MAT_FINAL_ASSEMBLY));
    work_.assemble_s += watch.read_s();
    places_ = state.x.head(system_.nodes().owned());
    projected_ = project;
    const bool first = work_.matrices++ == 0;
    if (first || last_cost_ > largest_growth * first_cost_) {
        make_preconditioner();
    } else {
        reused_ = true;
        must(KSPSetReusePreconditioner(ksp_.get(), PETSC_TRUE));
        must(KSPSetOperators(ksp_.get(), matrix_.get(), matrix_.get()));
        must(KSPSetUp(ksp_.get()));
    }
    work_.set_up_s += watch.read_s();
}

/// Builds a new preconditioner from the current matrix.
void LinearSolver::make_preconditioner() {
    set_near_null_space();
    set_options();  // a multigrid that is only reset is no longer positive definite
    must(KSPSetOperators(ksp_.get(), matrix_.get(), matrix_.get()));
    must(KSPSetUp(ksp_.get()));
    reused_ = false;
    first_cost_ = 0;
}

KSPConvergedReason LinearSolver::solve_by(KSP ksp, const Eigen::VectorXd& b, double error, Eigen::VectorXd& x) {
    x = Eigen::VectorXd::Zero(b.size());
    must(KSPSetTolerances(ksp, error, 1e-300, 1e10, most_iterations));
    must(VecPlaceArray(right_.get(), b.data()));
    must(VecPlaceArray(solution_.get(), x.data()));
    must(KSPSolve(ksp, right_.get(), solution_.get()));
    must(VecResetArray(right_.get()));
    must(VecResetArray(solution_.get()));
    system_.restrict_to_free(x);
    int iterations = 0;
    must(KSPGetIterationNumber(ksp, &iterations));
    last_cost_ = iterations / -std::log10(error);
    if (first_cost_ == 0) first_cost_ = last_cost_ + allowance;
    ++work_.solutions;
    work_.iterations += iterations;
    KSPConvergedReason reason{};
    must(KSPGetConvergedReason(ksp, &reason));
    return reason;
}

bool LinearSolver::solve(const Eigen::VectorXd& b, double error, Eigen::VectorXd& x) {
    Stopwatch watch;
    const LogStage stage("solve with tangents");
    // If the iterations run out, the direction is poor, not wrong: the line search decides.
    const auto good = [](KSPConvergedReason reason) { return reason > 0 || reason == KSP_DIVERGED_ITS; };
    KSPConvergedReason reason = solve_by(ksp_.get(), b, error, x);
    // Whether the matrix is indefinite does not depend on the preconditioner.
    if (!good(reason) && reused_ && reason != KSP_DIVERGED_INDEFINITE_MAT) {
        make_preconditioner();
        reason = solve_by(ksp_.get(), b, error, x);
    }
    // A projection is positive definite: it is the preconditioner that is not.
    if (!good(reason) && projected_) reason = solve_by(gmres_.get(), b, error, x);
    work_.solve_s += watch.read_s();
    return good(reason);
}

Eigen::VectorXd LinearSolver::forces_of(const Eigen::VectorXd& motion) const {
    Eigen::VectorXd local = Eigen::VectorXd::Zero(motion.size());
    linalg::add_product(local_.pattern, {values_.data(), values_.size()}, view(motion), 1, view(local));
    Eigen::VectorXd owned = system_.nodes().add_up(local);
    system_.restrict_to_free(owned);
    return owned;
}

}  // namespace pliant::sim::distributed
