// The wanted edge length at every point of a mesh.
#pragma once

#include <array>
#include <map>
#include <span>
#include <vector>

#include "geometry/mesher/mesher.hpp"
#include "geometry/meshing/walls.hpp"

namespace pliant::mesh {

/// The least of what the whole mesh, a body, the cables nearby and the walls nearby ask for. Lengths in the unit of the
/// bodies.
class SizeField {
public:
    SizeField(std::span<const BodyGeometry> bodies, const MeshSettings& settings);

    /// Walls of a first mesh, each to have so many elements through it (above zero; a half: edges twice as long as it
    /// is thick). Sizes go down to an eighth of the mesh size at most.
    void add_walls(const std::vector<WallSample>& walls, double elements);

    [[nodiscard]] double at(std::size_t body, const Vec3& p) const;
    /// Whether it is the same everywhere.
    [[nodiscard]] bool uniform() const;
    /// True if a wall asked for less than is allowed.
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
    std::map<Cell, double> walls_;  ///< (cells of edge size_) the least size that a wall in or beside the cell asks for
    bool too_thin_ = false;
};

}  // namespace pliant::mesh
