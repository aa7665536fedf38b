// Finds out why a pressure cannot be reached: many chambers have a maximum pressure, beyond which they grow at falling
// pressure.
#pragma once

#include <optional>

#include "simulation/solver/solver_chain.hpp"

namespace pliant::sim {

/// The maximum pressure of a chamber, with everything else held fixed.
struct PressureLimit {
    std::size_t chamber = 0;  ///< of the model
    double reached_Pa = 0;    ///< where the program stopped
    double largest_Pa = 0;
    double volume_ratio = 0;  ///< at the maximum
};

/// Switches each chamber with prescribed pressure to volume control, increases the volume from an equilibrium in steps
/// of one percent, and checks whether its pressure rises to a maximum and falls. Empty if no chamber shows that within
/// forty steps, or the pressure prescribed in `wanted` is reached. `state` is an equilibrium at `controls`; costs a few
/// solved steps.
[[nodiscard]] std::optional<PressureLimit> find_pressure_limit(const Equilibrium& system, SolverChain& solvers,
                                                               const Controls& controls, const Controls& wanted,
                                                               const StepSettings& settings, const State& state,
                                                               const Progress& progress);

}  // namespace pliant::sim
