// Struts between pillars that would fall over alone.
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

/// A rod that rises by 45 degrees from one pillar's axis to another's, which a printer builds without support.
struct Strut {
    Vec3 from_um, to_um;
    double radius_um = 0;
};

struct Braces {
    std::vector<Strut> struts;
    std::vector<bool> held;  ///< (pillars) whether a strut ends at it, or it is not slender
};

/// A pillar that is longer than so many of its diameters is slender: the pull of a layer that peels bends it aside. In
/// a bar clamped at one end the tip gives way with the cube of its length: at ten diameters it is a tenth as stiff as
/// at under five.
inline constexpr double slender = 10;

/// Every slender pillar is tied to its two nearest neighbours that stand at most `slender` diameters away, by struts to
/// and fro, one in every `slender` diameters of height that both have. `barred` tells of a rod that the part is in the
/// way of; such are left out. Struts are half as thick as their pillars, but not below `least_radius_um`.
[[nodiscard]] Braces braces(const std::vector<Pillar>& pillars, double least_radius_um,
                            const std::function<bool(const Strut&)>& barred);

}  // namespace pliant::slice
