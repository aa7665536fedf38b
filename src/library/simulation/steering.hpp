// Public names and units of actuators with a range.
#pragma once

#include <vector>

#include "library/simulation/data.hpp"
#include "pliant/inverse.hpp"
#include "simulation/parts/inverse_task.hpp"

namespace pliant::library {

[[nodiscard]] std::vector<SteeredInput> steered_inputs(const sim::Model& model, const sim::InverseTask& task);

}  // namespace pliant::library
