// Why a pressure cannot be reached: many chambers have a largest one, beyond which they grow at falling pressure.
#pragma once

#include <optional>

#include "simulation/solver/solver_chain.hpp"

namespace pliant::sim {

/// A maximum of a chamber's pressure, with everything else held as it is.
struct PressureLimit {
    std::size_t chamber = 0;  ///< of the model
    double reached_Pa = 0;    ///< where the program stopped
    double largest_Pa = 0;
    double volume_ratio = 0;  ///< at the largest
};

/// Drives each chamber whose pressure is given by its volume instead, from an equilibrium onwards in steps of one
/// percent, and looks whether its pressure rises, comes to a maximum and falls. Nothing, if no chamber shows that
/// within forty steps, or reaches the pressure that `wanted` asks for. `state` is an equilibrium at `controls`; costs a
/// few solved steps.
[[nodiscard]] std::optional<PressureLimit> find_pressure_limit(const Equilibrium& system, SolverChain& solvers,
                                                               const Controls& controls, const Controls& wanted,
                                                               const StepSettings& settings, const State& state,
                                                               const Progress& progress);

}  // namespace pliant::sim
