// Borders of surfaces, and seams: borders that exist only because a point was written twice with slightly different
// coordinates.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// A border edge of a surface: its triangles contain `times` more half-edges from `from` to `to` than back.
struct BorderEdge {
    int from, to;
    int times;  ///< 1 or more
};

/// The border of the surface, sorted by the lower, then the higher end of the edges.
[[nodiscard]] std::vector<BorderEdge> border_edges(const TriMesh& surface);

/// Triangles that would close the surface: from each connected piece of the border to its centre. Their points are
/// those of the surface followed by the centres.
[[nodiscard]] TriMesh border_caps(const TriMesh& surface);

struct ClosedSeams {
    std::size_t edges = 0;   ///< of the border, removed
    std::size_t points = 0;  ///< merged into another one
};

/// Merges border points no farther apart than `reach` and drops triangles that become degenerate and points that become
/// unused: programs compute a point once per triangle, with different rounding. No point moves by more than `reach`,
/// however many form a chain. The surface is unchanged if its border would not get shorter or nothing would be left of
/// it.
ClosedSeams close_seams(TriMesh& surface, double reach);

/// The same with the error of rounding points to 32 bits as reach, a millionth of the surface's size.
ClosedSeams close_seams(TriMesh& surface);

}  // namespace pliant::mesh
