#include "geometry/mesh/tet_locator.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

/// A grid of cubes, each cut into five tets.
TetMesh grid(int n) {
    TetMesh mesh;
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
            for (int k = 0; k <= n; ++k) mesh.points.push_back({1.0 * i, 1.0 * j, 1.0 * k});
        }
    }
    const auto node = [&](int i, int j, int k) { return (i * (n + 1) + j) * (n + 1) + k; };
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            for (int k = 0; k < n; ++k) {
                const int c[8] = {
                    node(i, j, k),     node(i + 1, j, k),     node(i + 1, j + 1, k),     node(i, j + 1, k),
                    node(i, j, k + 1), node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)};
                const int tets[5][4] = {{0, 1, 3, 4}, {1, 2, 3, 6}, {1, 4, 5, 6}, {3, 4, 6, 7}, {1, 3, 4, 6}};
                for (const auto& t : tets) {
                    for (const int corner : t) mesh.nodes.push_back(c[corner]);
                    mesh.region.push_back(0);
                }
            }
        }
    }
    mesh.region_names = {"all"};
    return mesh;
}

}  // namespace

TEST_CASE("points inside are found, and their weights reproduce them") {
    const TetMesh mesh = grid(5);
    const TetLocator locator(mesh);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(0, 5);
    for (int trial = 0; trial < 500; ++trial) {
        const Vec3 p{uniform(random), uniform(random), uniform(random)};
        const auto found = locator.locate(p);
        CHECK(found.distance == 0);
        Vec3 back;
        for (std::size_t a = 0; a < 4; ++a) {
            CHECK(found.barycentric[a] >= 0);
            back += found.barycentric[a] * mesh.points[mesh.tet(static_cast<std::size_t>(found.tet))[a]];
        }
        CHECK(norm(back - p) < 1e-12);
    }
}

TEST_CASE("points outside get the nearest point of the mesh") {
    const TetMesh mesh = grid(3);
    const TetLocator locator(mesh);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-8, 11);
    for (int trial = 0; trial < 300; ++trial) {
        const Vec3 p{uniform(random), uniform(random), uniform(random)};
        const Vec3 nearest{std::clamp(p.x, 0.0, 3.0), std::clamp(p.y, 0.0, 3.0), std::clamp(p.z, 0.0, 3.0)};
        CHECK(locator.locate(p).distance == near(norm(p - nearest), {.relative = 1e-12, .absolute = 1e-12}));
    }
}
