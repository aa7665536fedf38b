// Quantities with units, as robot and printer files write them: "12 MPa", "1040 kg/m^3", "50 um".
#pragma once

#include <string_view>

#include "base/core/error.hpp"

namespace pliant {

enum class Dimension {
    length,
    time,
    mass,
    force,
    pressure,
    density,
    speed,
    acceleration,
    volume,
    angle,
    irradiance,
    angular_speed,
    angular_acceleration,
    dose,
    stiffness,
    torque,
    inertia,
    torsional_stiffness  ///< the last one: is_unit() goes up to it
};

/// The name of a dimension and an example of it, for messages: `"a length such as \"2.5 mm\""`.
[[nodiscard]] std::string_view describe(Dimension dimension);

/// Value in SI units (angles in radians). The text is a finite number and a unit of that dimension, with or without a
/// space between them; the error names the accepted units.
[[nodiscard]] Result<double> parse_quantity(std::string_view text, Dimension dimension);

/// The factor from a unit's name to SI, as in `length_unit = "mm"`. A product is written with a space or a star:
/// "N mm" is "N*mm".
[[nodiscard]] Result<double> unit_factor(std::string_view unit, Dimension dimension);

/// True if quantities of some dimension are written in it, as robot and printer files write them.
[[nodiscard]] bool is_unit(std::string_view unit);

}  // namespace pliant
