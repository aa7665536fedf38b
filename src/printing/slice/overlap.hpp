// Bodies that overlap: who keeps which place, and how much of each others cover, exactly.
#pragma once

#include <span>
#include <vector>

#include "printing/slice/section.hpp"

namespace pliant::slice {

/// Areas of one body in one layer, in square units of the outlines.
struct Overlap {
    double others = 0;  ///< inside a later body, the last of which is of another material
    double own = 0;     ///< inside a later body, the last of which is of the same material, or wound around once more
};

/// A layer cut into the places that the last body in each keeps.
struct DividedLayer {
    std::vector<Overlap> areas;              ///< per body
    std::vector<std::vector<Segment>> kept;  ///< per body: closed outlines around what it keeps, but for level pieces
};

/// Divides a layer, to rounding. `outlines` per body, in an image (x: columns, y: rows): closed, either way round,
/// solid where the winding is not zero; they may cross themselves and each other. Kept outlines have their solid to
/// the right where they run to higher rows, and meet those of neighbours in the same numbers. The plane is cut into
/// bands between the heights of all corners and crossings; in a band outlines are straight and do not cross, so areas
/// are sums of trapezoids. Cost: bands times the outlines in each.
[[nodiscard]] DividedLayer divided(std::span<const std::vector<Segment>> outlines, std::span<const int> material_of);

}  // namespace pliant::slice
