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

constexpr int most_iterations = 2000;
/// Aggregates are kept while solutions with them take no more than this many times what the first one took.
constexpr double most_growth = 1.5;
constexpr int always_allowed = 10;

}  // namespace

LinearSolver::LinearSolver(const Balance& balance, Preconditioner preconditioner) : balance_(balance) {
    const Whole& whole = balance.share().whole;
    held_stiffness_ = whole.stiffest_Pa * std::cbrt(whole.volume_m3 / whole.tets);
    lay_out();
    make_matrix();
    const auto own = static_cast<PetscInt>(balance.nodes().owned());
    must(VecCreateMPIWithArray(balance.ranks().comm(), 3, own, PETSC_DECIDE, nullptr, right_.fill()));
    must(VecCreateMPIWithArray(balance.ranks().comm(), 3, own, PETSC_DECIDE, nullptr, solution_.fill()));
    must(KSPCreate(balance.ranks().comm(), ksp_.fill()));
    set_options(preconditioner);
}

void LinearSolver::lay_out() {
    const auto nodes = static_cast<int>(balance_.all_nodes().size());
    pattern_ = linalg::make_pattern(nodes, 3, balance_.cliques());
    sums_ = balance_.elements().block_sums(balance_.all_nodes(), pattern_);
    may_move_.assign(static_cast<std::size_t>(nodes), nullptr);
    for (const Balance::Roller& roller : balance_.rollers())
        may_move_[static_cast<std::size_t>(roller.node)] = &roller.may_move;
    const std::vector<char>& fixed = balance_.share().fixed;
    const auto for_places = [&](const auto& visit) {
        for (int j = 0; j < nodes; ++j) {
            for (int k = pattern_.node_start[static_cast<std::size_t>(j)];
                 k < pattern_.node_start[static_cast<std::size_t>(j) + 1]; ++k) {
                const int i = pattern_.node_row[static_cast<std::size_t>(k)];
                if (fixed[static_cast<std::size_t>(i)] != 0 || fixed[static_cast<std::size_t>(j)] != 0) continue;
                visit(i, Place{k, j, false});
                if (i != j) visit(j, Place{k, i, true});
            }
        }
    };
    row_start_.assign(static_cast<std::size_t>(nodes) + 1, 0);
    for_places([&](int row, const Place&) { ++row_start_[static_cast<std::size_t>(row) + 1]; });
    std::partial_sum(row_start_.begin(), row_start_.end(), row_start_.begin());
    places_.resize(static_cast<std::size_t>(row_start_.back()));
    std::vector<int> next(row_start_.begin(), row_start_.end() - 1);
    for_places([&](int row, const Place& place) {
        places_[static_cast<std::size_t>(next[static_cast<std::size_t>(row)]++)] = place;
    });
}

/// Room for what all ranks add: first into a matrix that only counts.
void LinearSolver::make_matrix() {
    const auto own = static_cast<PetscInt>(balance_.nodes().owned());
    const auto make = [&](MatType type, Owned<Mat, MatDestroy>& matrix) {
        must(MatCreate(balance_.ranks().comm(), matrix.fill()));
        must(MatSetSizes(matrix.get(), own, own, PETSC_DETERMINE, PETSC_DETERMINE));
        must(MatSetBlockSize(matrix.get(), 3));
        must(MatSetType(matrix.get(), type));
    };
    Owned<Mat, MatDestroy> counter;
    make(MATPREALLOCATOR, counter);
    must(MatSetUp(counter.get()));
    make(MATAIJ, matrix_);
    std::swap(counter, matrix_);
    values_.resize(pattern_.entries());
    parallel_clear(values_.span());
    add_rows(values_.span(), 1, false);
    hold();
    must(MatAssemblyBegin(matrix_.get(), MAT_FINAL_ASSEMBLY));
    must(MatAssemblyEnd(matrix_.get(), MAT_FINAL_ASSEMBLY));
    must(MatPreallocatorPreallocate(matrix_.get(), PETSC_TRUE, counter.get()));
    std::swap(counter, matrix_);
    must(MatSetOption(matrix_.get(), MAT_NEW_NONZERO_LOCATION_ERR, PETSC_TRUE));
    must(MatSetOption(matrix_.get(), MAT_SYMMETRIC, balance_.has_skew() ? PETSC_FALSE : PETSC_TRUE));
}

/// Adds the blocks of the pattern's lower triangle, and those above: their transposes, or with `skew` minus those.
void LinearSolver::add_rows(std::span<const double> values, double across, bool skew) {
    const std::vector<int>& number = balance_.share().number;
    RowBlock row;
    std::vector<PetscInt> columns;
    for (std::size_t i = 0; i + 1 < row_start_.size(); ++i) {
        const auto first = static_cast<std::size_t>(row_start_[i]), end = static_cast<std::size_t>(row_start_[i + 1]);
        if (first == end) continue;
        row.resize(3, 3 * static_cast<Eigen::Index>(end - first));
        columns.clear();
        for (std::size_t k = first; k < end; ++k) {
            const Place& place = places_[k];
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
        must(MatSetValuesBlocked(matrix_.get(), 1, &own, static_cast<PetscInt>(columns.size()), columns.data(),
                                 row.data(), ADD_VALUES));
    }
}

/// What is held has a stiffness of its own, coupled to nothing.
void LinearSolver::hold() {
    const Share& share = balance_.share();
    const auto add = [&](int node, const Eigen::Matrix3d& held) {
        const Eigen::Matrix3d block = held_stiffness_ * held;  // symmetric: by rows or by columns
        const PetscInt own = share.number[static_cast<std::size_t>(node)];
        must(MatSetValuesBlocked(matrix_.get(), 1, &own, 1, &own, block.data(), ADD_VALUES));
    };
    for (int node = 0; node < share.owned; ++node)
        if (share.fixed[static_cast<std::size_t>(node)] != 0) add(node, Eigen::Matrix3d::Identity());
    for (const Balance::Roller& roller : balance_.rollers())
        if (roller.node < share.owned) add(roller.node, Eigen::Matrix3d::Identity() - roller.may_move);
}

/// The rigid motions of the body as it is now: what the coarse levels must be able to do.
void LinearSolver::set_near_null_space(const Eigen::VectorXd& x) {
    Owned<Vec, VecDestroy> places;
    must(VecCreateMPI(balance_.ranks().comm(), static_cast<PetscInt>(balance_.nodes().owned()), PETSC_DETERMINE,
                      places.fill()));
    must(VecSetBlockSize(places.get(), 3));
    double* array = nullptr;
    must(VecGetArray(places.get(), &array));
    std::copy_n(x.data(), balance_.nodes().owned(), array);
    must(VecRestoreArray(places.get(), &array));
    Owned<MatNullSpace, MatNullSpaceDestroy> motions;
    must(MatNullSpaceCreateRigidBody(places.get(), motions.fill()));
    must(MatSetNearNullSpace(matrix_.get(), motions.get()));
}

void LinearSolver::set_options(Preconditioner preconditioner) {
    KSP ksp = ksp_.get();
    must(KSPSetType(ksp, balance_.has_skew() ? KSPGMRES : KSPCG));
    if (balance_.has_skew()) {
        must(KSPSetPCSide(ksp, PC_RIGHT));
        must(KSPGMRESSetRestart(ksp, 100));
    }
    must(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
    must(KSPSetInitialGuessNonzero(ksp, PETSC_FALSE));
    PC pc = nullptr;
    must(KSPGetPC(ksp, &pc));
    must(PCSetType(pc, preconditioner == Preconditioner::gamg ? PCGAMG : PCHYPRE));
    if (preconditioner == Preconditioner::gamg) {
        must(PCGAMGSetType(pc, PCGAMGAGG));
        must(PCGAMGSetNSmooths(pc, 1));
    } else {
        must(PCHYPRESetType(pc, "boomeramg"));
    }
    must(KSPSetFromOptions(ksp));
}

void LinearSolver::take(const State& state, bool project) {
    Stopwatch watch;
    must(MatZeroEntries(matrix_.get()));
    parallel_clear(values_.span());
    balance_.add_tangent(state, pattern_, sums_, values_.span(), project);
    add_rows(values_.span(), 1, false);
    if (balance_.has_skew() && !project) {
        std::vector<double> skew(values_.size(), 0.0);
        balance_.add_skew(state, pattern_, skew);
        add_rows(skew, -1, true);
    }
    hold();
    must(MatAssemblyBegin(matrix_.get(), MAT_FINAL_ASSEMBLY));
    must(MatAssemblyEnd(matrix_.get(), MAT_FINAL_ASSEMBLY));
    work_.assemble_s += watch.read_s();
    const bool worn = last_iterations_ > most_growth * first_iterations_ + always_allowed;
    PC pc = nullptr;
    must(KSPGetPC(ksp_.get(), &pc));
    if (!taken_ || worn) {
        set_near_null_space(state.x);
        first_iterations_ = 0;
    }
    must(PCGAMGSetReuseInterpolation(pc, taken_ && !worn ? PETSC_TRUE : PETSC_FALSE));
    must(KSPSetOperators(ksp_.get(), matrix_.get(), matrix_.get()));
    must(KSPSetUp(ksp_.get()));
    taken_ = true;
    ++work_.matrices;
    work_.set_up_s += watch.read_s();
}

bool LinearSolver::solve(const Eigen::VectorXd& b, double error, Eigen::VectorXd& x) {
    Stopwatch watch;
    x = Eigen::VectorXd::Zero(b.size());
    must(KSPSetTolerances(ksp_.get(), error, 1e-300, 1e10, most_iterations));
    must(VecPlaceArray(right_.get(), b.data()));
    must(VecPlaceArray(solution_.get(), x.data()));
    must(KSPSolve(ksp_.get(), right_.get(), solution_.get()));
    must(VecResetArray(right_.get()));
    must(VecResetArray(solution_.get()));
    balance_.restrict_to_free(x);
    must(KSPGetIterationNumber(ksp_.get(), &last_iterations_));
    if (first_iterations_ == 0) first_iterations_ = last_iterations_;
    ++work_.solutions;
    work_.iterations += last_iterations_;
    work_.solve_s += watch.read_s();
    KSPConvergedReason reason{};
    must(KSPGetConvergedReason(ksp_.get(), &reason));
    // Where the iterations have run out the direction is poor, not wrong: the line search will tell.
    return reason > 0 || reason == KSP_DIVERGED_ITS;
}

Eigen::VectorXd LinearSolver::forces_of(const Eigen::VectorXd& motion) const {
    Eigen::VectorXd known = Eigen::VectorXd::Zero(motion.size());
    linalg::add_product(pattern_, {values_.data(), values_.size()}, view(motion), 1, view(known));
    Eigen::VectorXd owned = balance_.nodes().add_up(known);
    balance_.restrict_to_free(owned);
    return owned;
}

}  // namespace pliant::sim::distributed
