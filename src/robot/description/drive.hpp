// The targets that drive the actuators of a robot.
#pragma once

#include <optional>

#include "robot/description/curve.hpp"

namespace pliant::robot {

/// Target of a cable: a linear ramp from rest to `value` at time 1, or a curve through keys.
struct CableTarget {
    enum class Kind { length_ratio, shortening_m, tension_N };
    Kind kind = Kind::length_ratio;
    double value = 1;
    std::optional<Curve> keys = std::nullopt;
    /// Added to the target from the first instant after rest: a length, m, or a tension, N.
    double offset = 0;
    [[nodiscard]] double at(double time) const;  ///< without the offset
    [[nodiscard]] double offset_at(double time) const { return time > 0 ? offset : 0; }
};

/// Target of a chamber, likewise. gas_ratio: the chamber is sealed and holds this multiple of the gas that it holds at
/// rest at ambient pressure; (p + p_ambient) V = gas_ratio p_ambient V_rest, at constant temperature.
struct ChamberTarget {
    enum class Kind { volume_ratio, volume_change_m3, pressure_Pa, gas_ratio };
    Kind kind = Kind::volume_ratio;
    double value = 1;
    std::optional<Curve> keys = std::nullopt;
    /// Added to the target from the first instant after rest: Pa, or m^3. None for gas.
    double offset = 0;
    [[nodiscard]] double at(double time) const;  ///< without the offset
    [[nodiscard]] double offset_at(double time) const { return time > 0 ? offset : 0; }
};

/// Stiffness with which air is held to its volume and a gap to its width, relative to the Young's modulus of the
/// softest body (the weight of A.4).
inline constexpr double default_air_weight = 0.1, default_gap_weight = 0.1;
inline constexpr double largest_space_weight = 1000;

}  // namespace pliant::robot
