// Brings a robot that is spread over ranks to equilibrium at fixed controls: solve_step (simulation/solver) with
// Newton's method.
#pragma once

#include "simulation/distributed/balance.hpp"
#include "simulation/distributed/linear_solver.hpp"
#include "simulation/distributed/turning.hpp"
#include "simulation/solver/step_solver.hpp"

namespace pliant::sim::distributed {

/// As sim::solve_step: the same merit, constraints and measure of convergence. Collective; `outcome.evaluation` is as
/// Balance makes it. Precondition: `state` is possible.
[[nodiscard]] StepOutcome solve_step(const Balance& balance, LinearSolver& linear, Turning& turning,
                                     const Controls& controls, const StepSettings& settings, State& state);

}  // namespace pliant::sim::distributed
