// What drives an actuator, from what a robot's program says of it, and what that adds to the evaluation of a state.
#pragma once

#include <cstddef>

#include "simulation/actuators/actuator.hpp"
#include "simulation/parts/description.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Of a cable or chamber whose target has this value. Actuators are counted as in Equilibrium: cables, chambers,
/// pressure loads. `rest_measure`: its length in m or volume in m^3 at rest.
[[nodiscard]] Drive drive_of(const Description& d, std::size_t actuator, double target, double offset,
                             double rest_measure);

/// Of any of them at `time` of the program.
[[nodiscard]] Drive drive_at(const Description& d, std::size_t actuator, double time, double rest_measure);

/// Compliance of a sealed chamber: -dg/dm.
[[nodiscard]] double gas_compliance(const Drive& drive, double multiplier, double ambient_pressure_Pa);

/// The measure of an actuator at a state and at rest, m or m^3.
struct Measured {
    double now = 0, rest = 0;
    bool only_pulls = false;
};
/// Adds what an actuator contributes to the evaluation: its energy, its multiplier if that is not the state's, and its
/// constraint violation. Precondition: `e` has the multipliers of the state, and violations of 0.
void add_drive(const Drive& drive, std::size_t actuator, const Measured& measure, double ambient_pressure_Pa,
               Evaluation& e);

}  // namespace pliant::sim
