// Reuses a factor, and L-BFGS pairs, after the body has rotated.
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
/// maps a motion of the body as it was then to the body as it is now: a motion that bent it then bends it now. An
/// inverse stiffness H^-1 from then becomes T H^-1 T^T. Rotating the motion of each node instead would stretch the
/// body: a uniform translation would not stay uniform. docs/theory.md, "The step solver", "Old factors".
class BodyRotation {
public:
    BodyRotation(const Equilibrium& system, const FactoredLaplacian& laplacian)
        : system_(&system), laplacian_(&laplacian) {}

    /// No rotation until the next call of follow(). `x` (3n).
    void begin(const Eigen::VectorXd& x);
    /// The nodes are at `x` (3n) now. Preconditions: begin() was called; no tet is inside out.
    void follow(const Eigen::VectorXd& x);

    /// The last `x` of follow() since begin(); null: there was none.
    [[nodiscard]] const std::shared_ptr<const Eigen::VectorXd>& followed() const { return followed_; }

    /// Columns (3 free, k): forces of now <- T^T forces, motions of before <- T motions.
    void pull_back_forces(Eigen::MatrixXd& columns) const;
    void push_forward_motions(Eigen::MatrixXd& columns) const;
    /// A motion of now <- L^-1 G^T W R^T G motion: nearly the inverse of push_forward_motions(). And the change of
    /// force that goes with it: as pull_back_forces().
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
