// Cure depth of a resin (Jacobs): a dose E cures to the depth Dp ln(E / Ec).
#pragma once

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// Depth against dose for one resin.
struct WorkingCurve {
    double penetration_um = 1;
    double critical_J_m2 = 1;
    [[nodiscard]] double depth_um(double dose_J_m2) const;
};

/// The resin's own curve, or the one through two points from the printer file: the exposure cures to `cure_depth`, and
/// its critical share to one layer.
[[nodiscard]] WorkingCurve working_curve(const Printer& printer, const Resin& resin);

/// Assumed of a resin of which the printer file says nothing: its exposure cures two layers, two depths of penetration.
[[nodiscard]] double assumed_penetration_um(const Printer& printer);

/// How deep an exposure cures by that curve.
[[nodiscard]] double cure_depth_um(const Printer& printer, const Resin& resin, double exposure_s);

/// An irradiance not given in the printer file is taken as 1: only ratios of doses matter then.
[[nodiscard]] double irradiance_W_m2(const Printer& printer);

}  // namespace pliant::machine
