// Impacts: steps in time in which contact, or the limit of a joint, changes velocities abruptly.
#pragma once

#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// True if in the step from `from` to `to` the forces of contact changed the velocity of an object, or of the robot, by
/// at least half of its value, or a joint was stopped so by one of its limits. Changes that move nothing by a hundredth
/// of the contact distance in a step do not count. `before`, `after`: the controls of both states; the inertia of the
/// step is in `after`. `touching`: what touches at the end.
[[nodiscard]] bool is_impact(const Equilibrium& system, const Touching& touching, const State& from,
                             const Controls& before, const State& to, const Controls& after);

}  // namespace pliant::sim
