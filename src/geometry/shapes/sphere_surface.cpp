#include "geometry/shapes/sphere_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

namespace pliant::mesh {
namespace {

struct Icosahedron {
    std::array<Vec3, 12> corners;
    std::array<std::array<int, 3>, 20> faces;  ///< counter-clockwise from outside
};

/// The corners are those of three rectangles whose sides are in the golden ratio.
Icosahedron icosahedron() {
    constexpr double g = std::numbers::phi;
    return {{{{-1, g, 0},
              {1, g, 0},
              {-1, -g, 0},
              {1, -g, 0},
              {0, -1, g},
              {0, 1, g},
              {0, -1, -g},
              {0, 1, -g},
              {g, 0, -1},
              {g, 0, 1},
              {-g, 0, -1},
              {-g, 0, 1}}},
            {{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
              {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
              {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}}};
}

/// Parts of each edge of the icosahedron, so that the largest triangle, in the middle of a face, deviates by the
/// tolerance at most. Its corners are R/√(3) · edge / inradius / parts from its centre: 0.764 R / parts.
int parts_for(double radius, double tolerance) {
    constexpr double share = 0.764 * 0.764 / 2;
    constexpr double most = 100;
    return static_cast<int>(std::clamp(std::ceil(std::sqrt(share * radius / tolerance)), 1.0, most));
}

class Division {
public:
    Division(const SphereSolid& sphere, int parts) : sphere_(sphere), parts_(parts), whole_(icosahedron()) {}

    TriMesh run() {
        for (const auto& face : whole_.faces) {
            for (int i = 0; i < parts_; ++i) {
                for (int j = 0; j < parts_ - i; ++j) {
                    const auto at = [&](int a, int b) { return point(face, {parts_ - a - b, a, b}); };
                    surface_.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
                    if (i + j + 1 < parts_)
                        surface_.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
                }
            }
        }
        return std::move(surface_);
    }

private:
    /// The corners with their shares of the parts, ascending, without those that have none: the same for both faces of
    /// an edge.
    using Name = std::vector<std::array<int, 2>>;

    int point(const std::array<int, 3>& face, const std::array<int, 3>& shares) {
        Name name;
        for (std::size_t k = 0; k < face.size(); ++k)
            if (shares[k] > 0) name.push_back({face[k], shares[k]});
        std::ranges::sort(name);
        const auto [known, is_new] = points_.try_emplace(name, static_cast<int>(surface_.points.size()));
        if (is_new) {
            Vec3 p;
            for (const auto& [corner, share] : name) p += static_cast<double>(share) * whole_.corners[corner];
            surface_.points.push_back(sphere_.center + sphere_.radius * unit(p));
        }
        return known->second;
    }

    SphereSolid sphere_;
    int parts_;
    Icosahedron whole_;
    std::map<Name, int> points_;
    TriMesh surface_;
};

}  // namespace

TriMesh sphere_surface(const SphereSolid& sphere, double tolerance) {
    return Division(sphere, parts_for(sphere.radius, tolerance)).run();
}

}  // namespace pliant::mesh
