// Converts public measures, by name, to those of the simulation, by index.
#pragma once

#include "pliant/linearisation.hpp"
#include "simulation/gradient/measure.hpp"
#include "simulation/model/model.hpp"

namespace pliant::library {

/// Throws if the robot has nothing of that name, or the direction is not finite.
[[nodiscard]] sim::Measure measure_for(const sim::Model& model, const Measure& asked);

}  // namespace pliant::library
