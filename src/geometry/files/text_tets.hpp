// Points and tets as the text formats list them, on their way to a TetMesh.
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
    std::vector<TenNodes> tets;  ///< by places in `points`; of 4-node tets the last six are -1
    std::vector<std::int64_t> regions;
    std::map<std::int64_t, std::string> names;  ///< of regions
};

/// The next three words as a point.
[[nodiscard]] Result<Vec3> read_point(TextScanner& scan);

/// The next `width` (4 or 10) words as the nodes of a tet, each the number of a point that was read before.
[[nodiscard]] Result<TenNodes> read_tet_nodes(TextScanner& scan, const NumberedPoints& points, std::size_t width);

/// The mesh. Mid-edge nodes are put in order by where they lie.
[[nodiscard]] Result<TetMesh> finish(TextTets&& read, const std::string& name);

}  // namespace pliant::mesh
