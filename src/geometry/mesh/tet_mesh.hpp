// Tetrahedral meshes, linear (4 nodes) and quadratic (10 nodes), with named regions.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/core/vec3.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

/// Mid-edge node 4 + e of a quadratic tet lies between its corners edge_corners[e] (the order of VTK and C3D10).
inline constexpr std::array<std::array<int, 2>, 6> edge_corners = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

/// Corners of the four faces, each seen counter-clockwise from outside; face f is opposite to corner f.
inline constexpr std::array<std::array<int, 3>, 4> face_corners = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

struct TetMesh {
    int order = 1;                          ///< 1: 4 nodes per tet, 2: 10 nodes per tet
    std::vector<Vec3> points;               ///< (n, 3)
    std::vector<int> nodes;                 ///< (m * nodes_per_tet), corners first, positively oriented
    std::vector<int> region;                ///< (m), index into region_names
    std::vector<std::string> region_names;  ///< at least one if there are tets
    std::vector<std::string> notes;         ///< oddities met by a reader or mesher; one line each, for people

    [[nodiscard]] int nodes_per_tet() const { return order == 2 ? 10 : 4; }
    [[nodiscard]] std::size_t tet_count() const { return nodes.size() / static_cast<std::size_t>(nodes_per_tet()); }
    [[nodiscard]] std::span<const int> tet(std::size_t t) const {
        const auto width = static_cast<std::size_t>(nodes_per_tet());
        return {nodes.data() + t * width, width};
    }
};

/// A face that belongs to only one tet (or separates two regions, where a function says so).
struct Face {
    std::array<int, 6> nodes;  ///< 3 corners, then for order 2 the mid-edge nodes between 0-1, 1-2, 2-0; else -1
    int tet;                   ///< the tet it belongs to; its normal points out of that tet
};

/// Inverts a tet of 4 or 10 nodes, or inverts it back.
void reverse_tet(std::span<int> nodes);

[[nodiscard]] double signed_tet_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sum of the volumes of the straight tets, over all regions or one.
[[nodiscard]] double volume(const TetMesh& mesh);
[[nodiscard]] double volume(const TetMesh& mesh, int region);

/// The faces of the outer surface (of one tet only), in the order of the tets.
[[nodiscard]] std::vector<Face> boundary_faces(const TetMesh& mesh);

/// The faces that bound one region, towards other regions or the outside.
[[nodiscard]] std::vector<Face> region_faces(const TetMesh& mesh, int region);

/// Two tets that share a face and lie on the same side of it.
struct OverlappingTets {
    int first, second;
    bool same;  ///< they have the same corners: one tet is listed twice
};
/// The first such pair, of the same tets if there are any. Tets that overlap without a common face are not found.
[[nodiscard]] std::optional<OverlappingTets> overlapping_tets(const TetMesh& mesh);
/// "tetrahedra 3 and 7 are the same", or that they overlap.
[[nodiscard]] std::string overlap_text(const OverlappingTets& pair);

/// Some regions of a mesh, with the nodes that they use.
struct Extract {
    TetMesh mesh;           ///< regions renumbered, in order
    std::vector<int> node;  ///< (nodes of the whole mesh) index in the extract, or -1
};
/// The tets of the regions for which `keep` (regions) is true.
[[nodiscard]] Extract extract_regions(const TetMesh& mesh, const std::vector<bool>& keep);

/// The closed surface of one region, points compacted; quadratic faces give four triangles each.
[[nodiscard]] TriMesh region_surface(const TetMesh& mesh, int region);

/// The same mesh with straight mid-edge nodes appended after the corner nodes. A quadratic mesh comes back unchanged.
[[nodiscard]] TetMesh to_quadratic(const TetMesh& mesh);

/// Multiplies every point by `factor` (a change of unit).
[[nodiscard]] TetMesh scaled(TetMesh mesh, double factor);

/// Shape functions at barycentric coordinates `b` (4 values, sum 1): 4 or 10 weights that sum to 1.
[[nodiscard]] std::vector<double> shape_functions(int order, const std::array<double, 4>& b);

}  // namespace pliant::mesh
