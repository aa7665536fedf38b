#include "simulation/distributed/step_rotation.hpp"

#include <cmath>

#include "base/core/stopwatch.hpp"
#include "base/linalg/vectors.hpp"

namespace pliant::sim::distributed {

using linalg::view;

StepRotation::StepRotation(const DistributedEquilibrium& system, const LocalPattern& local)
    : system_(system), local_(local) {
    Stopwatch watch;
    const LogStage stage("rotate steps");
    std::vector<double> values(local.pattern.node_row.size(), 0.0);
    system.elements().add_laplacian(local.sums, values);
    // The Laplacian has no directions: a node that is held in some is held partly in all.
    for (const DistributedEquilibrium::Roller& roller : system.rollers())
        values[static_cast<std::size_t>(local.pattern.node_start[static_cast<std::size_t>(roller.node)])] *=
            1 + (3 - roller.may_move.trace()) / 3;
    matrix_ = make_matrix(system, 1, [&](Mat matrix) { add_rows(matrix, values); });
    must(MatSetOption(matrix_.get(), MAT_SPD, PETSC_TRUE));
    const PetscInt own = system.share().owned;
    must(VecCreateMPIWithArray(system.ranks().comm(), 1, own, PETSC_DECIDE, nullptr, right_.fill()));
    must(VecCreateMPIWithArray(system.ranks().comm(), 1, own, PETSC_DECIDE, nullptr, solution_.fill()));
    must(KSPCreate(system.ranks().comm(), ksp_.fill()));
    KSP ksp = ksp_.get();
    must(KSPSetOptionsPrefix(ksp, "rotation_"));
    must(KSPSetType(ksp, KSPCG));
    must(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
    PC pc = nullptr;
    must(KSPGetPC(ksp, &pc));
    must(PCSetType(pc, PCGAMG));
    must(KSPSetFromOptions(ksp));
    must(KSPSetOperators(ksp, matrix_.get(), matrix_.get()));
    must(KSPSetUp(ksp));
    work_.set_up_s += watch.read_s();
}

void StepRotation::add_rows(Mat matrix, std::span<const double> values) const {
    const Share& share = system_.share();
    std::vector<PetscInt> columns;
    std::vector<double> row;
    for (std::size_t i = 0; i + 1 < local_.row_start.size(); ++i) {
        columns.clear();
        row.clear();
        for (int k = local_.row_start[i]; k < local_.row_start[i + 1]; ++k) {
            const LocalPattern::Place& place = local_.places[static_cast<std::size_t>(k)];
            columns.push_back(share.number[static_cast<std::size_t>(place.column)]);
            row.push_back(values[static_cast<std::size_t>(place.slot)]);
        }
        const PetscInt own = share.number[i];
        if (!columns.empty())
            must(MatSetValues(matrix, 1, &own, static_cast<PetscInt>(columns.size()), columns.data(), row.data(),
                              ADD_VALUES));
    }
    const double held = share.whole.stiffest_Pa * std::cbrt(share.whole.volume_m3 / share.whole.tets);
    for (int node = 0; node < share.owned; ++node)
        if (share.fixed[static_cast<std::size_t>(node)] != 0)
            must(MatSetValue(matrix, share.number[static_cast<std::size_t>(node)],
                             share.number[static_cast<std::size_t>(node)], held, ADD_VALUES));
}

Eigen::VectorXd StepRotation::rotate(const RotatingStep& rotating, double error) {
    Stopwatch watch;
    const LogStage stage("rotate steps");
    const Eigen::Index size = system_.nodes().local();
    Eigen::VectorXd turned = Eigen::VectorXd::Zero(size);
    system_.elements().add_rotation_term(rotating, view(turned));
    Eigen::VectorXd forces = system_.nodes().add_up(turned);
    system_.restrict_to_free(forces);
    Eigen::VectorXd correction(forces.size());
    must(KSPSetTolerances(ksp_.get(), error, 1e-300, 1e10, PETSC_DEFAULT));
    for (Eigen::Index c = 0; c < 3; ++c) {
        const Eigen::VectorXd right =
            Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<3>>(forces.data() + c, forces.size() / 3);
        Eigen::VectorXd x = Eigen::VectorXd::Zero(right.size());
        must(VecPlaceArray(right_.get(), right.data()));
        must(VecPlaceArray(solution_.get(), x.data()));
        must(KSPSolve(ksp_.get(), right_.get(), solution_.get()));
        must(VecResetArray(right_.get()));
        must(VecResetArray(solution_.get()));
        Eigen::Map<Eigen::VectorXd, 0, Eigen::InnerStride<3>>(correction.data() + c, x.size()) = x;
        int iterations = 0;
        must(KSPGetIterationNumber(ksp_.get(), &iterations));
        work_.iterations += iterations;
        ++work_.solutions;
    }
    system_.restrict_to_free(correction);
    work_.solve_s += watch.read_s();
    return Eigen::Map<const Eigen::VectorXd>(rotating.end, size) + system_.nodes().with_ghosts(correction);
}

}  // namespace pliant::sim::distributed
