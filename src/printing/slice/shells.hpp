// The connected pieces of a surface, and the sense of their triangles.
#pragma once

#include <vector>

#include "printing/slice/grid_surface.hpp"

namespace pliant::slice {

/// One use of an edge by a triangle; `a < b`, `forward` where the triangle runs from a to b.
struct EdgeUse {
    int a, b;
    int triangle;
    bool forward;
};

/// All edge uses, ordered by edge.
[[nodiscard]] std::vector<EdgeUse> edge_uses(const std::vector<Triangle>& triangles);

/// Whether every edge has exactly two uses that run against each other: the surface is closed and of one sense.
[[nodiscard]] bool all_paired(const std::vector<EdgeUse>& uses);

/// Turns triangles until neighbours across every edge that exactly two triangles share agree; in each connected piece
/// the smaller area is turned. Returns how many triangles were turned.
int orient_consistently(GridSurface& surface);

/// Which piece each triangle belongs to, counted from 0; pieces are joined by edges that exactly two triangles share.
struct Shells {
    int count = 0;
    std::vector<int> of_triangle;  ///< (m)
};
[[nodiscard]] Shells find_shells(const GridSurface& surface, const std::vector<EdgeUse>& uses);

/// Turns shells whose inside is outside: all of them where the whole surface is inside out, else each one that encloses
/// a negative volume and lies in no other shell's box (one that does is a cavity). Returns how many were turned.
/// Precondition: the surface is closed, `uses` are those of its edges.
int turn_inverted_shells(GridSurface& surface, const std::vector<EdgeUse>& uses);

}  // namespace pliant::slice
