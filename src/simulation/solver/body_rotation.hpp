// Reuses a factor, and L-BFGS pairs, after a rotation of the body.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "base/core/aligned_array.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// With R the rotation of each integration point since the factor was made and the Laplacian L = G^T W G,
///   T = L^-1 G^T W R G
/// maps a motion of the old configuration to the rotated one: bending remains the same bending. An old inverse
/// stiffness H^-1 becomes T H^-1 T^T. Rotating the motion of each node instead would stretch the body: a uniform
/// translation would not stay uniform. docs/theory.md, "The step solver", "Old factors".
class BodyRotation {
public:
    BodyRotation(const Equilibrium& system, const FactoredLaplacian& laplacian)
        : system_(&system), laplacian_(&laplacian) {}

    /// Resets the rotation to none until the next call of follow(). `x` (3n).
    void begin(const Eigen::VectorXd& x);
    /// Computes the rotation to the node positions `x` (3n). Preconditions: begin() was called; no tet is inverted.
    void follow(const Eigen::VectorXd& x);

    /// The last `x` of follow() since begin(); null if there was none.
    [[nodiscard]] const std::shared_ptr<const Eigen::VectorXd>& followed() const { return followed_; }

    /// Columns (3 free, k): current forces <- T^T forces, motions of the old configuration <- T motions.
    void pull_back_forces(Eigen::MatrixXd& columns) const;
    void push_forward_motions(Eigen::MatrixXd& columns) const;
    /// A current motion <- L^-1 G^T W R^T G motion: approximately the inverse of push_forward_motions(). And the
    /// corresponding change of force: as pull_back_forces().
    void pull_back_step(Eigen::VectorXd& motion, Eigen::VectorXd& force) const;

private:
    void apply(Elements::Direction direction, Eigen::Ref<Eigen::MatrixXd> columns) const;

    const Equilibrium* system_;
    const FactoredLaplacian* laplacian_;
    Eigen::VectorXd before_;          ///< (3n)
    AlignedArray<double> rotations_;  ///< of all points
    std::shared_ptr<const Eigen::VectorXd> followed_;
};

}  // namespace pliant::sim
