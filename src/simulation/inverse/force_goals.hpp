// Forces of obstacles and supports on the robot as goals: their values and derivatives.
#pragma once

#include "simulation/linearisation/linearisation.hpp"
#include "simulation/parts/inverse_task.hpp"
#include "simulation/stepper/robot_state.hpp"

namespace pliant::sim::inverse {

/// The force of the goal's obstacle or support on the robot, N; only its magnitude, as the first number, if the goal
/// asks for that.
[[nodiscard]] Vec3 force_of(const Equilibrium& system, const State& state, const Controls& controls,
                            const Evaluation& evaluation, const Goal& goal);

/// The derivative of each number of force_of(): three, or one for the magnitude. Contact friction is held frozen, and
/// friction of a cable is treated as if its forces had a potential.
[[nodiscard]] std::vector<Quantity> force_gradients(Linearisation& at, const Goal& goal);

}  // namespace pliant::sim::inverse
