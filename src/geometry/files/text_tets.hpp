// Points and tets as read from the text formats, before they become a TetMesh.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "geometry/files/mid_edge_order.hpp"
#include "geometry/files/numbered_points.hpp"
#include "geometry/files/text_scanner.hpp"
#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

struct TextTets {
    NumberedPoints points;
    std::vector<TenNodes> tets;  ///< indices into `points`; for 4-node tets the last six are -1
    std::vector<std::int64_t> regions;
    std::map<std::int64_t, std::string> names;  ///< names of regions
};

/// The next three words as a point.
[[nodiscard]] Result<Vec3> read_point(TextScanner& scan);

/// Reads the next `width` (4 or 10) words as the nodes of a tet, each the number of a point read before.
[[nodiscard]] Result<TenNodes> read_tet_nodes(TextScanner& scan, const NumberedPoints& points, std::size_t width);

/// The mesh. Mid-edge nodes are reordered by position (mid_edge_order.hpp).
[[nodiscard]] Result<TetMesh> finish(TextTets&& read, const std::string& name);

}  // namespace pliant::mesh
