// Recovers the flat faces of a triangulated surface, as they were drawn.
#pragma once

#include <memory>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh {

/// A closed surface as flat polygons. Neighbours share the points of their common edges.
struct FacetedSurface {
    using Loop = std::vector<int>;     ///< points, in order
    using Face = std::vector<Loop>;    ///< its outline, then its holes
    using Shell = std::vector<Face>;   ///< closed
    using Piece = std::vector<Shell>;  ///< its outer shell, then its cavities
    std::vector<Vec3> points;
    std::vector<Piece> pieces;
};

/// Merges triangles that are coplanar within the rounding of 32-bit coordinates, and moves corners by as little to
/// where their planes meet. Errors: a surface that is not closed (check_closed()), or has more than `most` faces.
[[nodiscard]] Result<FacetedSurface> flat_faces(const TriMesh& surface, std::size_t most);

/// A solid that other solids may touch, from a closed surface of at most 400 flat faces, of which at most 40 meet
/// another one at less than 30 degrees; more would mean a round surface.
[[nodiscard]] Result<Solid> polyhedron(const TriMesh& surface);

}  // namespace pliant::mesh
