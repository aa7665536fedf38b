// Which cables are taut: one that becomes so stops what it holds, as an impact does.
#pragma once

#include <vector>

#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Ascending indices of the cables that pull, or are as long as prescribed up to rounding.
[[nodiscard]] std::vector<int> taut_cables(const Equilibrium& system, const State& state, const Controls& controls);
/// Of these, the cables whose length is prescribed.
[[nodiscard]] std::vector<int> holding_cables(const Equilibrium& system, const State& state, const Controls& controls);

}  // namespace pliant::sim
