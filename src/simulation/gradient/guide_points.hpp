// Derivatives of a measure with respect to the guide points of cables and springs: the rest positions at which they are
// attached to the mesh.
#pragma once

#include <span>

#include "simulation/gradient/variation.hpp"

namespace pliant::sim {

/// (3 guides). `by_rest_measure` (actuators): derivatives with respect to the measure of each actuator at rest, which
/// includes the rest length of a path. The tension shares of a cable with friction are held fixed, and so are gap
/// elements that a cable acts through.
[[nodiscard]] Eigen::VectorXd guide_gradient(const Linearisation& at, const Adjoint& adjoint, const Slope& of,
                                             const Eigen::VectorXd& by_rest_measure,
                                             std::span<const GuidePoint> guides);

}  // namespace pliant::sim
