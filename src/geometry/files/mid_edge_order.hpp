// Finds the order in which a file lists the mid-edge nodes of its 10-node tets. Formats and the programs that write
// them differ; the positions of the nodes decide.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/core/error.hpp"
#include "base/core/vec3.hpp"

namespace pliant::mesh {

/// Gmsh's place of each node of our 10-node tet, and the reverse: its last two mid-edge nodes are swapped.
inline constexpr std::array<std::size_t, 10> gmsh_order = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};

using TenNodes = std::array<std::int64_t, 10>;

/// Reorders the nodes of all tets to match edge_corners (tet_mesh.hpp): each of the file's six slots goes to the edge
/// whose midpoint is nearest in most of the first 1000 tets. Corners stay first. Precondition: every node is an index
/// into `points`. Error: two slots match the same edge.
[[nodiscard]] Status order_mid_edge_nodes(std::span<const Vec3> points, std::span<TenNodes> tets);

}  // namespace pliant::mesh
