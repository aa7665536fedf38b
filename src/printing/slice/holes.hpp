// Closing the holes of a surface.
#pragma once

#include "printing/slice/grid_surface.hpp"

namespace pliant::slice {

struct Holes {
    int count = 0;           ///< wider than a crack of 1 um; cracks are closed without being counted
    int edges = 0;           ///< around those holes
    double area_mm2 = 0;     ///< of all new triangles
    std::int32_t z_low = 0;  ///< of the holes, grid units
    std::int32_t z_high = 0;
};

/// Adds triangles until every directed edge has its opposite, so that every plane section is a set of closed loops. The
/// rim of a hole is traversed in the orientation of the missing triangles; a flat rim gets exactly the missing surface,
/// any other a fan around the centroid of its corners.
Holes close_holes(GridSurface& surface);

}  // namespace pliant::slice
