#include "printing/machine/working_curve.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::machine {

double irradiance_W_m2(const Printer& printer) {
    return printer.projector.irradiance_W_m2 > 0 ? printer.projector.irradiance_W_m2 : 1;
}

double WorkingCurve::depth_um(double dose_J_m2) const {
    return dose_J_m2 > critical_J_m2 ? penetration_um * std::log(dose_J_m2 / critical_J_m2) : 0;
}

double assumed_penetration_um(const Printer& printer) {
    return printer.layer_um;
}

double cure_depth_um(const Printer& printer, const Resin& resin, double exposure_s) {
    return working_curve(printer, resin).depth_um(irradiance_W_m2(printer) * exposure_s);
}

WorkingCurve working_curve(const Printer& printer, const Resin& resin) {
    if (resin.penetration_um > 0) return {resin.penetration_um, resin.critical_J_m2};
    const double dose = irradiance_W_m2(printer) * resin.exposure_s;
    const double depth = resin.cure_depth_um;
    const double layer = std::min<double>(printer.layer_um, depth / 2);
    const double share = resin.critical_share;
    const double penetration = share < 1 ? (depth - layer) / std::log(1 / share) : depth;
    return {penetration, dose * std::exp(-depth / penetration)};
}

}  // namespace pliant::machine
