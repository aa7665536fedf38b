// Mass and damping of a robot: the inertia terms of a step in time.
#pragma once

#include <memory>

#include "simulation/elements/inertia.hpp"
#include "simulation/model/model.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Both arguments must outlive it.
class MotionInTime {
public:
    MotionInTime(const Model& model, const Damping& damping) : model_(model), damping_(damping) {}

    /// Undeformed at `x` (3n) and with zero velocity, except objects, which have their initial velocities.
    [[nodiscard]] History at_rest(const Eigen::VectorXd& x) const;
    /// With zero velocity everywhere.
    [[nodiscard]] static History still(const Eigen::VectorXd& x);
    /// For a step of `dt` from the end of `history`. Stiffness damping uses Elements::add_strain_stiffness at
    /// Inertia::damping_place.
    [[nodiscard]] std::shared_ptr<const Inertia> inertia(const History& history, double dt,
                                                         Scheme scheme = Scheme::even);
    /// The history after a step that ends at `x`.
    [[nodiscard]] static History after(const Inertia& inertia, const Eigen::VectorXd& x);
    [[nodiscard]] double kinetic_energy_J(const History& history) const;

private:
    [[nodiscard]] std::shared_ptr<const TangentLayout> make_body_layout() const;

    const Model& model_;
    Damping damping_;
    std::shared_ptr<const TangentLayout> body_layout_;  ///< made on first use by stiffness damping
};

}  // namespace pliant::sim
