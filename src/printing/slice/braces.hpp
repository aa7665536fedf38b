// Struts between pillars that are too slender to stand alone.
#pragma once

#include <functional>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::slice {

/// The upright part of a support.
struct Pillar {
    double x_um = 0, y_um = 0;
    double low_um = 0, high_um = 0;
    double radius_um = 0;

    [[nodiscard]] double slenderness() const { return (high_um - low_um) / (2 * radius_um); }
};

/// A rod that rises at 45 degrees from one pillar's axis to another's, which prints without support.
struct Strut {
    Vec3 from_um, to_um;
    double radius_um = 0;
};

struct Braces {
    std::vector<Strut> struts;
    std::vector<bool> held;  ///< (pillars) true if a strut ends at it, or it is not slender
};

/// A pillar longer than this many diameters is slender: the peel force bends it. The tip deflection of a cantilever
/// grows with the cube of its length: at ten diameters it is a tenth as stiff as at under five.
inline constexpr double slender = 10;

/// Every slender pillar is tied to its two nearest neighbours within `slender` diameters by struts in alternating
/// directions, one per `slender` diameters of their common height. `barred` says whether the part blocks a rod; such
/// rods are left out. Struts are half as thick as their pillars, but not thinner than `least_radius_um`.
[[nodiscard]] Braces braces(const std::vector<Pillar>& pillars, double least_radius_um,
                            const std::function<bool(const Strut&)>& barred);

}  // namespace pliant::slice
