// Triangles in a bounding volume hierarchy, for fast queries.
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

    /// How many times the surface winds around a point: 1 inside a closed surface, 0 outside, and in between if it has
    /// holes (generalised winding number: Jacobson, Kavan, Sorkine-Hornung 2013). Distant triangles are merged into one
    /// dipole (Barill, Dickson, Schmidt, Levin, Jacobson 2018), with an error of a few hundredths at most. Cost: about
    /// log n.
    [[nodiscard]] double winding_number(const Vec3& point) const;

    /// The first triangle hit by the ray beyond `from`, and its distance in units of the length of `direction`.
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
        Vec3 centre;   ///< area-weighted
        double reach;  ///< from the centre to the farthest corner
        int begin, end;
        int left = -1, right = -1;
    };
    int build(int begin, int end);
    [[nodiscard]] std::array<Vec3, 3> corners(int triangle) const;

    TriMesh surface_;
    std::vector<int> order_;  ///< triangles; those of each node are contiguous
    std::vector<Node> nodes_;
};

}  // namespace pliant::mesh
