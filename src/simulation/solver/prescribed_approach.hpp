// Supports and obstacles that push against the robot on their way.
#pragma once

#include "simulation/solver/curvature.hpp"
#include "simulation/solver/step_solver.hpp"

namespace pliant::sim {

/// Brings supports and obstacles from where they are at `from`, with `state` at equilibrium there, to where `to` wants
/// them, in as many pieces as it takes for nothing to pass through anything: the robot gives way to each piece as its
/// tangent says, and is brought back near equilibrium before the next. For motions that go further in one step than the
/// gap that contact leaves. `state` is then near its equilibrium at `to`, and possible. False: the robot is not pushed
/// away by what comes, or the tangent is not at hand; `state` is then of no use.
/// Precondition: the model has contact.
[[nodiscard]] bool approach(const Equilibrium& system, const FactoredLaplacian& laplacian, const Controls& from,
                            const Controls& to, State& state, const Progress& progress);

}  // namespace pliant::sim
