// What nothing holds at an equilibrium, but the tether to the step before it.
#pragma once

#include <string>

#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// In which ways pieces of the robot that no support holds, and objects, can move as a whole without contact, friction,
/// springs, cables or gravity holding them, in words and without a full stop; "" if there are none. `controls`: with
/// the tether of the step that led to `state`. Cost: a search for what touches, and a dense matrix of six rows for each.
[[nodiscard]] std::string left_open(const Equilibrium& system, const State& state, const Controls& controls);

}  // namespace pliant::sim
