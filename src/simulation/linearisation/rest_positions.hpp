// How a state changes with the shape of the robot: with the rest positions of its nodes.
#pragma once

#include "simulation/linearisation/linearisation.hpp"

namespace pliant::sim {

/// How the equations change with a motion (3n) of the rest positions of all nodes. Guide points, markers and walls ride
/// on their nodes as before; a node that is held moves along, and turns with its support; springs that are free at rest
/// become as long as their path, plates and masses follow. The surface of an object moves along with its four nodes,
/// and its mass stays. Wanted lengths and volumes stay (in m and m^3, see rest_measure_gradient), as do loads, what is
/// lagged, the lengths and directions of cables in the gaps that gap elements act through, and the areas and reaches
/// that contact takes from the rest state.
[[nodiscard]] Derivative derivative_by_rest(Linearisation& at, const Eigen::VectorXd& motion);

/// (3n) dq/dX by the rest positions of all nodes at once: the transpose of the same.
[[nodiscard]] Eigen::VectorXd rest_gradient(Linearisation& at, const Adjoint& adjoint);

/// (3n) how an actuator's measure at rest changes with the rest positions. Where a length or volume is wanted as a
/// ratio r, dq/dX has in addition dq/d(wanted) * r times this.
[[nodiscard]] Eigen::VectorXd rest_measure_gradient(const Equilibrium& system, std::size_t actuator);

}  // namespace pliant::sim
