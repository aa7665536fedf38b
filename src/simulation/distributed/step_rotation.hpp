// Steps that rotate a body instead of stretching it: FactoredLaplacian::rotate (simulation/solver) on many ranks.
#pragma once

#include <petscksp.h>

#include <Eigen/Core>

#include "simulation/distributed/distributed_equilibrium.hpp"
#include "simulation/distributed/linear_work.hpp"
#include "simulation/distributed/local_pattern.hpp"
#include "simulation/distributed/petsc.hpp"

namespace pliant::sim::distributed {

/// The weighted Laplacian of a robot, with one number per pair of nodes, and its multigrid, which is set up once.
class StepRotation {
public:
    /// Both must outlive it. Collective.
    StepRotation(const DistributedEquilibrium& system, const LocalPattern& local);

    /// The positions of the local nodes (3n) that result if the rotations of a step are applied exactly at each
    /// integration point and the resulting deformation gradients are made compatible by the Laplacian; with an error of
    /// `error` times the difference from the straight step. Held nodes take their positions from `rotating.end`.
    /// Collective.
    [[nodiscard]] Eigen::VectorXd rotate(const RotatingStep& rotating, double error);

    [[nodiscard]] const LinearWork& work() const { return work_; }

private:
    void add_rows(Mat matrix, std::span<const double> values) const;

    const DistributedEquilibrium& system_;
    const LocalPattern& local_;
    Owned<Mat, MatDestroy> matrix_;
    Owned<KSP, KSPDestroy> ksp_;
    Owned<Vec, VecDestroy> right_, solution_;
    LinearWork work_;
};

}  // namespace pliant::sim::distributed
