// Derivatives of a state with respect to the rest positions of the nodes.
#pragma once

#include "simulation/linearisation/linearisation.hpp"

namespace pliant::sim {

/// Derivative of the equations along a motion (3n) of the rest positions of all nodes. Guide points, markers and walls
/// keep their weights at their nodes; a held node moves along, and rotates with its support; springs without a given
/// free length adapt it to their path; plates and masses follow. The surface of an object moves along with its four
/// nodes, and its mass is unchanged; a load on faces stays spread over them evenly per area. Held fixed are prescribed
/// lengths and volumes (in m and m^3, see rest_measure_gradient), the shares of other loads, lagged quantities, the
/// lengths and directions of cables in gaps with gap elements, and the areas and reaches that contact takes from the
/// rest state.
[[nodiscard]] Derivative derivative_by_rest(Linearisation& at, const Eigen::VectorXd& motion);

/// (3n) dq/dX with respect to the rest positions of all nodes: the transpose of the same.
[[nodiscard]] Eigen::VectorXd rest_gradient(Linearisation& at, const Adjoint& adjoint);

/// (3n) derivative of an actuator's measure at rest with respect to the rest positions. If a length or volume is
/// prescribed as a ratio r, dq/dX has an additional term dq/d(wanted) * r times this.
[[nodiscard]] Eigen::VectorXd rest_measure_gradient(const Equilibrium& system, std::size_t actuator);

}  // namespace pliant::sim
