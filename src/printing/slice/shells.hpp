// The connected components of a surface, and the orientation of their triangles.
#pragma once

#include <vector>

#include "printing/slice/grid_surface.hpp"

namespace pliant::slice {

/// One use of an edge by a triangle; `a < b`, `forward` if the triangle runs from a to b.
struct EdgeUse {
    int a, b;
    int triangle;
    bool forward;
};

/// All edge uses, ordered by edge.
[[nodiscard]] std::vector<EdgeUse> edge_uses(const std::vector<Triangle>& triangles);

/// Whether every edge has exactly two uses in opposite directions: the surface is closed and consistently oriented.
[[nodiscard]] bool all_paired(const std::vector<EdgeUse>& uses);

/// Flips triangles until neighbours agree across every edge that exactly two triangles share; in each component the
/// smaller area is flipped. Returns how many triangles were flipped.
int orient_consistently(GridSurface& surface);

/// The component of each triangle, counted from 0; components are connected by edges that exactly two triangles share.
struct Shells {
    int count = 0;
    std::vector<int> of_triangle;  ///< (m)
};
[[nodiscard]] Shells find_shells(const GridSurface& surface, const std::vector<EdgeUse>& uses);

/// Flips shells that are inside out: all of them if the whole surface is, else each one that encloses a negative volume
/// and is in no other shell's box (one that is, is a cavity). Returns how many were flipped. Precondition: the surface
/// is closed, `uses` are those of its edges.
int turn_inverted_shells(GridSurface& surface, const std::vector<EdgeUse>& uses);

}  // namespace pliant::slice
