// How deep light cures a resin (Jacobs): a dose E cures to the depth Dp ln(E / Ec).
#pragma once

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// Depth over dose of one resin.
struct WorkingCurve {
    double penetration_um = 1;
    double critical_J_m2 = 1;
    [[nodiscard]] double depth_um(double dose_J_m2) const;
};

/// The resin's own curve, or one through the two points that the printer file gives: the exposure cures `cure_depth`,
/// and its critical share just one layer.
[[nodiscard]] WorkingCurve working_curve(const Printer& printer, const Resin& resin);

/// Light of an irradiance that the printer file leaves open is 1: all that matters is its share of the exposure.
[[nodiscard]] double irradiance_W_m2(const Printer& printer);

}  // namespace pliant::machine
