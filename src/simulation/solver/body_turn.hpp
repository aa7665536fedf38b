// What was learnt about a body before it turned, used after.
#pragma once

#include <Eigen/Core>

#include "base/core/aligned_array.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// With R the rotation of each point between two states, T = L^-1 G^T W R G takes a motion of the body as it was before
/// to that of the body as it is now, L = G^T W G being the Laplacian; what bent the body before bends it now. To turn
/// the motions of nodes themselves would stretch it: a motion that is the same everywhere would no longer be. An
/// inverse stiffness H^-1 from before is T H^-1 T^T now.
class BodyTurn {
public:
    BodyTurn(const Equilibrium& system, const FactoredLaplacian& laplacian)
        : system_(&system), laplacian_(&laplacian) {}

    /// Nothing turns until the next call of follow(). `x` (3n).
    void begin(const Eigen::VectorXd& x);
    /// The nodes are at `x` (3n) now. Preconditions: begin() was called; no tet is inside out.
    void follow(const Eigen::VectorXd& x);

    /// Columns (3 free, k): forces of now <- T^T forces, motions of before <- T motions.
    void forces_back(Eigen::MatrixXd& columns) const;
    void motions_on(Eigen::MatrixXd& columns) const;
    /// A motion of now <- L^-1 G^T W R^T G motion: nearly the inverse of motions_on(). And the change of force that
    /// goes with it: as forces_back().
    void step_back(Eigen::VectorXd& motion, Eigen::VectorXd& force) const;

private:
    void apply(Elements::Direction direction, Eigen::Ref<Eigen::MatrixXd> columns) const;

    const Equilibrium* system_;
    const FactoredLaplacian* laplacian_;
    Eigen::VectorXd before_;          ///< (3n)
    AlignedArray<double> rotations_;  ///< of all points
    bool turned_ = false;
};

}  // namespace pliant::sim
