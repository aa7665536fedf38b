// The target edge length at every point of a mesh.
#pragma once

#include <array>
#include <map>
#include <span>
#include <vector>

#include "geometry/mesher/mesher.hpp"
#include "geometry/meshing/walls.hpp"

namespace pliant::mesh {

/// The minimum of the sizes of the whole mesh, the body, nearby cables and nearby walls. Lengths in the unit of the
/// bodies.
class SizeField {
public:
    SizeField(std::span<const BodyGeometry> bodies, const MeshSettings& settings);

    /// Walls of a first mesh, each to get this many elements through it (above zero; 0.5: edges twice as long as the
    /// wall is thick). Sizes go down to an eighth of the mesh size at most.
    void add_walls(const std::vector<WallSample>& walls, double elements);

    [[nodiscard]] double at(std::size_t body, const Vec3& p) const;
    /// Whether the size is the same everywhere.
    [[nodiscard]] bool uniform() const;
    /// True if a wall needed a size below the allowed minimum.
    [[nodiscard]] bool too_thin() const { return too_thin_; }

private:
    using Cell = std::array<int, 3>;
    [[nodiscard]] Cell cell_of(const Vec3& p) const;
    [[nodiscard]] double near_cables(const Vec3& p) const;
    [[nodiscard]] double near_walls(const Vec3& p) const;

    double size_;
    std::vector<double> body_;
    double cable_size_;
    std::vector<std::vector<Vec3>> cables_;
    std::map<Cell, double> walls_;  ///< (cells of edge size_) the smallest size required by a wall in or beside the
                                    ///< cell
    bool too_thin_ = false;
};

}  // namespace pliant::mesh
