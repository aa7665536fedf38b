// Makes any surface ready for slicing: closed, oriented outwards, on the grid.
#pragma once

#include <string>
#include <vector>

#include "printing/slice/body.hpp"
#include "printing/slice/grid_surface.hpp"
#include "printing/slice/layers.hpp"

namespace pliant::slice {

struct Repaired {
    GridSurface surface;                ///< closed: every directed edge has its opposite
    std::vector<std::string> warnings;  ///< each begins with `label`
};

/// Snaps, merges points at open edges that are at most `join_um` apart, orients and closes. Holes up to a quarter of
/// the surface are closed with a warning that names their layers (counted from 0, as in `layers`). Errors: what
/// snap_to_grid rejects, a surface without triangles, larger holes, a surface that encloses nothing.
[[nodiscard]] Result<Repaired> repair(const mesh::TriMesh& surface_um, const std::string& label, const Layers& layers,
                                      double join_um = 0);

}  // namespace pliant::slice
