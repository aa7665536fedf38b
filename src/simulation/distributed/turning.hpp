// Steps that turn a body instead of stretching it: FactoredLaplacian::rotate (simulation/solver) on many ranks.
#pragma once

#include <petscksp.h>

#include <Eigen/Core>

#include "simulation/distributed/balance.hpp"
#include "simulation/distributed/known_pattern.hpp"
#include "simulation/distributed/linear_work.hpp"
#include "simulation/distributed/petsc.hpp"

namespace pliant::sim::distributed {

/// The weighted Laplacian of a robot, one number for each pair of nodes, and its multigrid: made once.
class Turning {
public:
    /// Both must outlive it. Collective.
    Turning(const Balance& balance, const KnownPattern& known);

    /// The positions of the known nodes (3n) that result if the rotations of a step are applied exactly at each
    /// integration point and the Laplacian reconciles what this gives; to `error` of the difference to the straight
    /// step. Held nodes are where `rotating.end` has them. Collective.
    [[nodiscard]] Eigen::VectorXd rotate(const RotatingStep& rotating, double error);

    [[nodiscard]] const LinearWork& work() const { return work_; }

private:
    void add_rows(Mat matrix, std::span<const double> values) const;

    const Balance& balance_;
    const KnownPattern& known_;
    Owned<Mat, MatDestroy> matrix_;
    Owned<KSP, KSPDestroy> ksp_;
    Owned<Vec, VecDestroy> right_, solution_;
    LinearWork work_;
};

}  // namespace pliant::sim::distributed
