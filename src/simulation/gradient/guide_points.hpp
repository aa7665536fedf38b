// How a measure changes with the guide points of cables and springs: with where in the rest shape they are tied to the
// mesh.
#pragma once

#include <span>

#include "simulation/gradient/variation.hpp"

namespace pliant::sim {

/// (3 guides). `by_rest_measure` (actuators): by what each measure is at rest, of which the length of the path there is
/// one. Shares of a cable with friction stay as they are, and so do gap elements that a cable acts through.
[[nodiscard]] Eigen::VectorXd guide_gradient(const Linearisation& at, const Adjoint& adjoint, const Slope& of,
                                             const Eigen::VectorXd& by_rest_measure,
                                             std::span<const GuidePoint> guides);

}  // namespace pliant::sim
