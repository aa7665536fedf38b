// The triangles, edges and points of a surface that may be in contact.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::sim::contact {

/// Indices of nodes; every edge once, edges and points ascending.
struct Surface {
    std::vector<std::array<int, 3>> triangles;  ///< (m, 3)
    std::vector<std::array<int, 2>> edges;      ///< (e, 2), the smaller node first
    std::vector<int> points;                    ///< (p)
};

[[nodiscard]] Surface make_surface(std::span<const std::array<int, 3>> triangles);

/// The boundary of a robot: its faces, those of quadratic tets in four flat triangles each.
[[nodiscard]] Surface robot_surface(const mesh::TetMesh& mesh);

/// Areas in m². Points and edges represent a third of each adjacent triangle; each list sums to the whole area.
struct SurfaceAreas {
    std::vector<double> points;     ///< (p), in the order of Surface::points
    std::vector<double> edges;      ///< (e)
    std::vector<double> triangles;  ///< (m)
};
/// `positions`: (3 nodes) metres.
[[nodiscard]] SurfaceAreas surface_areas(const Surface& surface, std::span<const double> positions);

/// Node `i` of positions (3 nodes).
[[nodiscard]] inline Vec3 node_at(std::span<const double> positions, int i) {
    const double* p = positions.data() + 3 * static_cast<std::size_t>(i);
    return {p[0], p[1], p[2]};
}

}  // namespace pliant::sim::contact
