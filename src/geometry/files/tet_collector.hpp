// Picks the tets out of what a mesh file holds; every reader of tet meshes ends here.
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

    /// Room for as many tets with as many nodes in all.
    void reserve(std::size_t tets, std::size_t nodes);

    /// One tet of 4 or 10 nodes (indices into the file's points, order of VTK) in the region with this number.
    [[nodiscard]] Status add(std::span<const std::int64_t> nodes, std::int64_t region);

    /// Where tets of 4 and of 10 nodes meet in one file all get 10: new mid-edge nodes are straight, but where a tet of
    /// 10 nodes has the same edge its node is shared; a note counts them. Points that no tet uses are dropped,
    /// inside-out tets are turned (a note counts them), regions come in the order of their first tet with the name of
    /// their number, or the number itself. An error if there are no tets.
    [[nodiscard]] Result<TetMesh> finish(const std::map<std::int64_t, std::string>& names);

private:
    std::vector<Vec3> points_;
    std::vector<int> index_;
    std::vector<bool> linear_;  ///< (tets) of 4 nodes
    std::map<std::int64_t, int> region_of_;
    std::int64_t last_region_ = 0;  ///< of the tet that was added last
    TetMesh mesh_;
};

}  // namespace pliant::mesh
