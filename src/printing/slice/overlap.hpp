// Overlapping bodies: which one keeps each place, and exact overlap areas.
#pragma once

#include <span>
#include <vector>

#include "printing/slice/section.hpp"

namespace pliant::slice {

/// Areas of one body in one layer, in square units of the outlines.
struct Overlap {
    double others = 0;  ///< inside later bodies, the last of which is of another material
    double own = 0;     ///< inside later bodies, the last of which is of the same material, or inside the body itself a
                        ///< second time
};

/// A layer divided among its bodies: each place belongs to the last body there.
struct DividedLayer {
    std::vector<Overlap> areas;              ///< per body
    std::vector<std::vector<Segment>> kept;  ///< per body: closed outlines of what it keeps, without horizontal pieces
};

/// Divides a layer, exactly up to rounding. `outlines` per body, in an image (x: columns, y: rows): closed, in either
/// orientation, solid where the winding number is not zero; they may intersect themselves and each other. Kept outlines
/// have their solid to the right where they run to higher rows, and share exact coordinates with those of neighbours.
/// Outlines that stay apart are divided apart, with what surrounds them: the many pillars of a part's supports. Each
/// such cluster is cut into bands between the heights of its corners and intersections; within a band outlines are
/// straight and do not cross, so areas are sums of trapezoids. Cost: bands times the outlines in each, over all
/// clusters.
[[nodiscard]] DividedLayer divided(std::span<const std::vector<Segment>> outlines, std::span<const int> material_of);

}  // namespace pliant::slice
