// Public names and units of actuators with a range, and the inputs of the robot at their values.
#pragma once

#include <span>
#include <vector>

#include "library/simulation/data.hpp"
#include "pliant/inverse.hpp"
#include "simulation/parts/inverse_task.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::library {

[[nodiscard]] std::vector<SteeredInput> steered_inputs(const sim::Model& model, const sim::InverseTask& task);
/// All inputs of the robot: those of its program at `time`, with the values of the steered ones, (task inputs) each in
/// the unit of its target.
[[nodiscard]] Inputs inputs_at(const sim::Equilibrium& system, const sim::InverseTask& task,
                               std::span<const double> values, double time);

}  // namespace pliant::library
