// Solves for the equilibrium of a distributed robot at fixed controls: solve_step (simulation/solver) with Newton's
// method.
#pragma once

#include "simulation/distributed/distributed_equilibrium.hpp"
#include "simulation/distributed/linear_solver.hpp"
#include "simulation/distributed/step_rotation.hpp"
#include "simulation/solver/step_solver.hpp"

namespace pliant::sim::distributed {

/// As sim::solve_step: the same merit, constraints and measure of convergence. Collective; `outcome.evaluation` is one
/// of DistributedEquilibrium. Precondition: `state` is possible.
[[nodiscard]] StepOutcome solve_step(const DistributedEquilibrium& system, LinearSolver& linear, StepRotation& rotation,
                                     const Controls& controls, const StepSettings& settings, State& state);

}  // namespace pliant::sim::distributed
