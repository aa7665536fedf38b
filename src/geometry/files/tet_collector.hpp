// Collects the tets of a mesh file; every reader of tet meshes ends here.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

class TetCollector {
public:
    /// All points of the file.
    explicit TetCollector(std::vector<Vec3> points) : points_(std::move(points)), index_(points_.size(), -1) {}

    /// Reserves space for this many tets and this many nodes in total.
    void reserve(std::size_t tets, std::size_t nodes);

    /// Adds a tet of 4 or 10 nodes (indices into the file's points, VTK order) to the region with this number.
    [[nodiscard]] Status add(std::span<const std::int64_t> nodes, std::int64_t region);

    /// If tets of 4 and of 10 nodes are mixed, all get 10: new mid-edge nodes are at midpoints unless a 10-node tet
    /// already has a node on the edge; a note counts them. Unused points are dropped, inverted tets are reversed (a
    /// note counts them), regions come in the order of their first tet, named by `names` or else by their number.
    /// Error: no tets.
    [[nodiscard]] Result<TetMesh> finish(const std::map<std::int64_t, std::string>& names);

private:
    std::vector<Vec3> points_;
    std::vector<int> index_;
    std::vector<bool> linear_;  ///< (tets) true for 4-node tets
    std::map<std::int64_t, int> region_of_;
    std::int64_t last_region_ = 0;  ///< region of the tet added last
    TetMesh mesh_;
};

}  // namespace pliant::mesh
