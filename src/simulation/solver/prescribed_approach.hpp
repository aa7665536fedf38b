// Prescribed motion of supports and obstacles that push against the robot.
#pragma once

#include "simulation/solver/curvature.hpp"
#include "simulation/solver/step_solver.hpp"

namespace pliant::sim {

/// Moves supports and obstacles from their positions in `from`, where `state` is in equilibrium, to those in `to`, in
/// as many increments as needed to avoid intersections: the robot yields to each increment according to its tangent,
/// and is brought back near equilibrium before the next. For motions larger than the contact gap in one step. `state`
/// is then physically possible and near its equilibrium at `to`. False: the robot is not pushed away, or the tangent is
/// not available; `state` is then unusable. Precondition: the model has contact.
[[nodiscard]] bool approach(const Equilibrium& system, const FactoredLaplacian& laplacian, const Controls& from,
                            const Controls& to, State& state, const Progress& progress);

}  // namespace pliant::sim
