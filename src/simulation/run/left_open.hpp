// Finds motions at an equilibrium that only the tether resists.
#pragma once

#include <string>

#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Rigid motions of objects, and of pieces of the robot without support, that neither contact, friction, springs,
/// cables nor gravity resist; as text without a full stop, "" if there are none. `controls`: with the tether of the
/// step that led to `state`. Cost: a proximity search, and a dense matrix of six rows for each piece or object.
[[nodiscard]] std::string left_open(const Equilibrium& system, const State& state, const Controls& controls);

/// Names a piece or an object that falls: in the quasi-static step from `before` (3n) to `state` its weight and loads
/// moved it by many times the robot's size, in a direction that only the tether resists at `state`. A sentence without
/// a full stop; "" if none does. Cost, once something has moved so far: that of left_open().
[[nodiscard]] std::string falling(const Equilibrium& system, const State& state, const Controls& controls,
                                  const Eigen::VectorXd& before);

/// False if the robot has too many pieces and objects for left_open(), which then says nothing.
[[nodiscard]] bool can_tell_left_open(const Model& model);

}  // namespace pliant::sim
