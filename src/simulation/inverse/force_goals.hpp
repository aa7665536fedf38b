// Forces of obstacles and supports on the robot, as goals: their values, and how they change with the state.
#pragma once

#include "simulation/linearisation/linearisation.hpp"
#include "simulation/parts/inverse_task.hpp"
#include "simulation/stepper/robot_state.hpp"

namespace pliant::sim::inverse {

/// The force of the goal's obstacle or support on the robot, N; its size in all as the first number where the goal asks
/// for that.
[[nodiscard]] Vec3 force_of(const Equilibrium& system, const State& state, const Controls& controls,
                            const Evaluation& evaluation, const Goal& goal);

/// The derivative of each number of force_of(): three, or one of the size. Where friction acts it is taken as frozen,
/// and a cable's friction as if its forces had a potential.
[[nodiscard]] std::vector<Quantity> force_gradients(Linearisation& at, const Goal& goal);

}  // namespace pliant::sim::inverse
