// Finds the tet that contains a point.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// A uniform grid over the boxes of the tets, curved edges included. The mesh must outlive it.
class TetLocator {
public:
    explicit TetLocator(const TetMesh& mesh);

    struct Location {
        int tet = -1;
        std::array<double, 4>
            barycentric{};    ///< of the nearest point of that tet, for its shape functions; sum 1, none negative
        double distance = 0;  ///< from the query to that point; 0 inside
    };
    /// The tet that contains the point or, outside the mesh, the nearest one; ties go to the lowest index.
    /// Precondition: the mesh has tets.
    [[nodiscard]] Location locate(const Vec3& point) const;

private:
    using Cell = std::array<int, 3>;
    void choose_cells(double wanted);
    /// How many cells the boxes of the tets meet, each tet's counted.
    [[nodiscard]] std::size_t entries() const;
    /// The first and last cell that the tet's box meets.
    [[nodiscard]] std::pair<Cell, Cell> cells_of(std::size_t tet) const;
    [[nodiscard]] Cell cell_of(const Vec3& point) const;
    [[nodiscard]] std::size_t cell_count() const { return cell_index(cells_[0] - 1, cells_[1] - 1, cells_[2] - 1) + 1; }
    [[nodiscard]] std::size_t cell_index(int i, int j, int k) const {
        return (static_cast<std::size_t>(i) * static_cast<std::size_t>(cells_[1]) + static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(cells_[2]) +
               static_cast<std::size_t>(k);
    }
    [[nodiscard]] Box3 bounds_of(std::size_t tet) const;
    void try_tet(int tet, const Vec3& point, Location& best) const;

    const TetMesh* mesh_;
    std::vector<bool> curved_;  ///< (tets)
    Box3 box_;
    Cell cells_ = {1, 1, 1};
    double cell_size_ = 1;
    std::vector<std::size_t> start_;  ///< (cells + 1)
    std::vector<int> tets_;
};

}  // namespace pliant::mesh
