// Triangles in a tree of boxes, for questions that a list of them answers too slowly.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

class TriangleTree {
public:
    /// Keeps a copy of the surface. Cost: n log n.
    explicit TriangleTree(TriMesh surface);

    /// How often the surface winds around a point: 1 inside a closed surface, 0 outside, and in between where it has
    /// holes (generalised winding number: Jacobson, Kavan, Sorkine-Hornung 2013). Far triangles count as one dipole
    /// (Barill, Dickson, Schmidt, Levin, Jacobson 2018), which changes it by some hundredths at most. Cost: about log
    /// n.
    [[nodiscard]] double winding_number(const Vec3& point) const;

    /// Distance along the ray to the first triangle beyond `from` times the length of `direction`, and which one.
    struct Hit {
        double distance;
        int triangle;
    };
    [[nodiscard]] std::optional<Hit> first_hit(const Vec3& origin, const Vec3& direction, double from) const;

    [[nodiscard]] const TriMesh& surface() const { return surface_; }

private:
    struct Node {
        Box3 box;
        Vec3 dipole;   ///< sum of area times normal
        Vec3 centre;   ///< of area
        double reach;  ///< from the centre to the farthest corner
        int begin, end;
        int left = -1, right = -1;
    };
    int build(int begin, int end);
    [[nodiscard]] std::array<Vec3, 3> corners(int triangle) const;

    TriMesh surface_;
    std::vector<int> order_;  ///< triangles, so that every node's are in a row
    std::vector<Node> nodes_;
};

}  // namespace pliant::mesh
