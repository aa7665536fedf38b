// What drives an actuator, from what a robot's program says of it.
#pragma once

#include <cstddef>

#include "simulation/actuators/actuator.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

/// Of a cable or chamber whose target has this value. Actuators are counted as in Equilibrium: cables, chambers,
/// pressure loads. `rest_measure`: its length in m or volume in m^3 at rest.
[[nodiscard]] Drive drive_of(const Description& d, std::size_t actuator, double target, double offset,
                             double rest_measure);

/// Of any of them at `time` of the program.
[[nodiscard]] Drive drive_at(const Description& d, std::size_t actuator, double time, double rest_measure);

}  // namespace pliant::sim
