// The reference problems of the test suite: structured meshes, the .tet files and the CSV tables with reference values.
// Used by tests, benchmarks and calibrate (the bar of kuhn_box).
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "simulation/model/model.hpp"

namespace pliant::sim::reference {

/// Box [0, size] in nx x ny x nz cells of six tets each, one for every permutation of the axes on the walk from the
/// cell's low to its high corner, mirrored in every second cell so that faces match (Kuhn). Node (i, j, k) has index
/// (i * (ny + 1) + j) * (nz + 1) + k. `region_of` takes a centroid. Metres.
[[nodiscard]] mesh::TetMesh kuhn_box(Vec3 size, int nx, int ny, int nz, const std::function<int(Vec3)>& region_of);

/// A text mesh: "n m", nodes, tets with material, number of sets, then one line "name count nodes..." each.
struct NamedMesh {
    mesh::TetMesh mesh;
    std::map<std::string, std::vector<int>> sets;
};
[[nodiscard]] NamedMesh load_tet(const std::string& path, double unit);

/// Rows of a CSV file with a header line, by column name.
using Row = std::map<std::string, std::string>;
[[nodiscard]] std::vector<Row> load_csv(const std::string& path);

/// Nodes for which `inside` holds at rest.
[[nodiscard]] std::vector<int> nodes_where(const mesh::TetMesh& mesh, const std::function<bool(Vec3)>& inside);

/// The mean of `nodes`: equal weights.
[[nodiscard]] Attachment mean_of(std::vector<int> nodes);

/// The folder that PLIANT_REFERENCE_DATA names.
[[nodiscard]] std::string data_folder();

}  // namespace pliant::sim::reference
