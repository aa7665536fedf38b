// Readings of a robot's sensors in a state.
//
//     strain     strain, length                            of a path
//     backbone   bend, twist, curvature; curvature_k, twist_rate_k of each piece
//     contact    force_x, _y, _z, normal_force, area, pressure of a patch
//     tension, volume, pressure, distance
//     motion     acceleration_x, _y, _z, angular_velocity_x, _y, _z    in the sensor's own axes
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Quantity of a reading. Values are in SI units; shown() gives the unit for display.
enum class SensedQuantity {
    ratio,
    length,
    angle,
    curvature,
    twist_rate,
    force,
    area,
    volume,
    pressure,
    acceleration,
    angular_velocity,
};

/// Display of a quantity: "" and 1 for a ratio, "_mm" and 1000 for a length.
struct Shown {
    std::string_view suffix;
    double factor;
    std::string_view unit;     ///< as shown: "mm"
    std::string_view si_unit;  ///< of the value: "m"
};
[[nodiscard]] Shown shown(SensedQuantity quantity);

struct Reading {
    std::string name;
    SensedQuantity quantity = SensedQuantity::ratio;
    double value = 0;
};

/// Names and quantities of what read_sensor() gives.
[[nodiscard]] std::vector<std::pair<std::string, SensedQuantity>> readings_of(const Sensor& sensor);

/// Without the inertia of a step in time, a motion sensor is at rest, as before the first step: it reads the
/// acceleration that supports it against gravity.
[[nodiscard]] std::vector<Reading> read_sensor(const Sensor& sensor, const Equilibrium& system, const State& state,
                                               const Controls& controls);

/// Tension, or minus the pressure, that a cable or chamber (first the cables) exerts on the body. The resistance of gap
/// elements and meshed air is excluded; for air it is the pressure beyond that resistance to volume change.
[[nodiscard]] double acting_multiplier(const Equilibrium& system, const State& state, std::size_t actuator);

}  // namespace pliant::sim
