// In which order does a file list the mid-edge nodes of its 10-node tets? Formats differ and so do the programs that
// write them; where the nodes lie says it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/core/error.hpp"
#include "base/core/vec3.hpp"

namespace pliant::mesh {

using TenNodes = std::array<std::int64_t, 10>;

/// Brings the nodes of all tets into the order of edge_corners (tet_mesh.hpp): each of a file's six places goes to the
/// edge whose middle is nearest in most of the first 1000 tets. Corners stay first. Precondition: every node is an
/// index into `points`. An error if two places ask for one edge.
[[nodiscard]] Status order_mid_edge_nodes(std::span<const Vec3> points, std::span<TenNodes> tets);

}  // namespace pliant::mesh
