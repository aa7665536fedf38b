// A robot that has mass and damping: what a step in time adds to its equations.
#pragma once

#include <memory>

#include "simulation/elements/inertia.hpp"
#include "simulation/model/model.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Both outlive it.
class MotionInTime {
public:
    MotionInTime(const Model& model, const Damping& damping) : model_(model), damping_(damping) {}

    /// Undeformed at `x` (3n) and still, but for objects, which have the velocities that they start with.
    [[nodiscard]] History at_rest(const Eigen::VectorXd& x) const;
    /// All of it still.
    [[nodiscard]] static History still(const Eigen::VectorXd& x);
    /// For a step of `dt` from where `history` ends. Damping by stiffness takes the stiffness there.
    [[nodiscard]] std::shared_ptr<const Inertia> inertia(const History& history, double dt,
                                                         Scheme scheme = Scheme::even);
    /// After a step that ends at `x`.
    [[nodiscard]] static History after(const Inertia& inertia, const Eigen::VectorXd& x);
    [[nodiscard]] double kinetic_energy_J(const History& history) const;

private:
    [[nodiscard]] std::shared_ptr<const TangentLayout> make_body_layout() const;

    const Model& model_;
    Damping damping_;
    std::shared_ptr<const TangentLayout> body_layout_;  ///< made when damping by stiffness first needs it
};

}  // namespace pliant::sim
