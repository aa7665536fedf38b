// The adjoint of one step of a program: from derivatives with respect to its end to those with respect to its start.
#pragma once

#include <memory>
#include <vector>

#include "simulation/contact/friction.hpp"
#include "simulation/gradient/friction_slips.hpp"
#include "simulation/gradient/variation.hpp"

namespace pliant::sim {

/// Derivatives of an objective with respect to the end of a step, through the steps after it; all zero after the last
/// one.
struct Carried {
    Eigen::VectorXd x, v;                ///< (3n) with respect to position and velocity at the end of the step
    Eigen::VectorXd x_before, v_before;  ///< (3n) the same for the step before
    Eigen::VectorXd obstacles;           ///< (3 obstacle nodes) with respect to the positions of the obstacles
    /// Friction of the next step, and derivatives with respect to the initial slip of each of its pairs, along the
    /// pair's tangents.
    std::shared_ptr<const contact::Friction> friction{};
    Slips slips{};
    [[nodiscard]] static Carried nothing(const Equilibrium& system);
    [[nodiscard]] bool is_nothing() const;
};

/// Distributes the carried derivatives, and those of this step's own contribution, over everything that the step
/// depends on; updates what is carried to the end of the step before.
[[nodiscard]] Result<Variation> go_back_over(Linearisation& at, const Slope& own, const By& by, Carried& carried);

}  // namespace pliant::sim
