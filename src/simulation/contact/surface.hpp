// The triangles, edges and points of a surface that may be in contact.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::sim::contact {

/// Indices of nodes; every edge at most once, edges and points ascending.
struct Surface {
    std::vector<std::array<int, 3>> triangles;  ///< (m, 3)
    std::vector<std::array<int, 2>> edges;      ///< (e, 2), the smaller node first
    std::vector<int> points;                    ///< (p)
    /// (m) the flat face of which a triangle is a part, named after an edge inside it: the smaller node times the
    /// number of nodes, plus the other one; -1: it is a face by itself. Empty: all are.
    std::vector<std::int64_t> flat_face{};
    /// (p) whether a point lies inside a flat face. Empty: none does.
    std::vector<char> inside_face{};

    /// Whether the i-th point acts on the faces of others.
    [[nodiscard]] bool acts(std::size_t i) const { return inside_face.empty() || inside_face[i] == 0; }
};

[[nodiscard]] Surface make_surface(std::span<const std::array<int, 3>> triangles);

/// The surface of something rigid, whose flat faces act as a whole, however they are divided into triangles: without
/// the edges and points inside them, since an edge of something else is nearest to a flat face at one of its own ends
/// or at the face's boundary. They would push things sideways and turn them: a point near an edge inside has two
/// triangles in reach, what is left of a pair of nearly parallel edges (the mollifier) depends on the angle between
/// them, and what slides over the face would meet the points in its way. `positions`: (3 nodes) metres.
[[nodiscard]] Surface make_rigid_surface(std::span<const std::array<int, 3>> triangles,
                                         std::span<const double> positions);

/// The boundary of a robot: its faces, those of quadratic tets in four flat triangles each.
[[nodiscard]] Surface robot_surface(const mesh::TetMesh& mesh);

/// Areas in m². Points represent a third of each adjacent triangle, edges an equal share; both lists sum to the whole
/// area, that of edges to the area of the triangles that have any. A triangle of a flat face represents all of it, and
/// the points on its boundary represent those inside too.
struct SurfaceAreas {
    std::vector<double> points;     ///< (p), in the order of Surface::points
    std::vector<double> edges;      ///< (e)
    std::vector<double> triangles;  ///< (m); without flat faces they sum to the whole area
};
/// `positions`: (3 nodes) metres.
[[nodiscard]] SurfaceAreas surface_areas(const Surface& surface, std::span<const double> positions);

/// Node `i` of positions (3 nodes).
[[nodiscard]] inline Vec3 node_at(std::span<const double> positions, int i) {
    const double* p = positions.data() + 3 * static_cast<std::size_t>(i);
    return {p[0], p[1], p[2]};
}

}  // namespace pliant::sim::contact
