// Finds the tet that contains a point.
#pragma once

#include <array>
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
    [[nodiscard]] std::array<int, 3> cell_of(const Vec3& point) const;
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
    std::array<int, 3> cells_ = {1, 1, 1};
    double cell_size_ = 1;
    std::vector<int> start_;  ///< (cells + 1)
    std::vector<int> tets_;
};

}  // namespace pliant::mesh
