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

/// Thin tets around the diagonal of a cube, which they share: the box of each is nearly the whole cube.
TetMesh fan(int n) {
    TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 1, 1}};
    const Vec3 across = Vec3{1, -1, 0} / std::sqrt(2.0), up = Vec3{1, 1, -2} / std::sqrt(6.0);
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * std::acos(-1.0) * i / n;
        const Vec3 off = 0.1 * (std::cos(angle) * across + std::sin(angle) * up);
        mesh.points.push_back(Vec3{0.5, 0.5, 0.5} + off);
        mesh.nodes.insert(mesh.nodes.end(), {0, 1, 2 + i, 2 + (i + 1) % n});
        mesh.region.push_back(0);
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

TEST_CASE("long tets around a diagonal are found, with a grid that stays small") {
    for (const int n : {300, 70000}) {  // the boxes of the latter would meet more than two thousand million cells
        const TetMesh mesh = fan(n);
        const TetLocator locator(mesh);
        for (int t = n / 3; t < n; t += n / 2) {
            Vec3 middle;
            for (std::size_t a = 0; a < 4; ++a) middle += 0.25 * mesh.points[mesh.tet(static_cast<std::size_t>(t))[a]];
            const auto found = locator.locate(middle);
            CHECK(found.tet == t);
            CHECK(found.distance < 1e-10);
        }
    }
}

TEST_CASE("weights in a thin tet sum to 1") {
    TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0.3, 0.1}, {0.2, 1, 0.7}, {0.4, 0.43, 0.26}};
    mesh.nodes = {0, 1, 2, 3};
    mesh.region = {0};
    mesh.region_names = {"all"};
    for (const double height : {1e-6, 1e-9, 1e-12, 1e-14, 1e-16}) {
        const Vec3 normal = cross(mesh.points[1], mesh.points[2]);
        mesh.points[3] = (mesh.points[1] + mesh.points[2]) / 3 + height * normal;
        const Vec3 inside = 0.25 * (mesh.points[1] + mesh.points[2] + mesh.points[3]);
        const auto found = TetLocator(mesh).locate(inside);
        const auto& w = found.barycentric;
        CHECK(w[0] + w[1] + w[2] + w[3] == near(1.0, {.relative = 1e-14}));
        CHECK(found.distance < 1e-8);
    }
}
