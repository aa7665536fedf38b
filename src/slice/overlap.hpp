// How much of each body later bodies cover too, exactly.
#pragma once

#include <span>
#include <vector>

#include "slice/section.hpp"

namespace pliant::slice {

/// Areas of one body in one layer, in square units of the outlines.
struct Overlap {
    double others = 0;  ///< inside a later body, the last of which is of another material
    double own = 0;     ///< inside a later body, the last of which is of the same material
};

/// Areas where bodies overlap, to rounding. `outlines` per body: closed, solid where the winding is not zero; they may
/// cross themselves and each other. The plane is cut into bands between the heights of all corners and crossings; in a
/// band outlines are straight and do not cross, so areas are sums of trapezoids. Cost: bands times the outlines in
/// each.
[[nodiscard]] std::vector<Overlap> overlaps(std::span<const std::vector<Segment>> outlines,
                                            std::span<const int> material_of);

}  // namespace pliant::slice
