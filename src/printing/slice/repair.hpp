// From a surface as it comes to one that can be cut: closed, outwards, on the grid.
#pragma once

#include <string>
#include <vector>

#include "printing/slice/body.hpp"
#include "printing/slice/grid_surface.hpp"
#include "printing/slice/layers.hpp"

namespace pliant::slice {

struct Repaired {
    GridSurface surface;                ///< closed: every directed edge has its opposite
    std::vector<std::string> warnings;  ///< each starts with `label`
};

/// Snaps, joins points at open edges that are no farther apart than `join_um`, orients and closes. Holes up to a
/// quarter of the surface are closed with a warning that names their layers (counted from 0, as `layers` has them).
/// Errors: what snap_to_grid refuses, a surface without triangles, one that is more open than that, one that encloses
/// nothing.
[[nodiscard]] Result<Repaired> repair(const mesh::TriMesh& surface_um, const std::string& label, const Layers& layers,
                                      double join_um = 0);

}  // namespace pliant::slice
