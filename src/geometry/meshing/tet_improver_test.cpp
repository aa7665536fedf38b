#include "geometry/meshing/tet_improver.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "geometry/mesh/mesh_report.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

TetMesh mesh_of_tets(std::vector<Vec3> points, const std::vector<std::array<int, 4>>& tets) {
    TetMesh mesh;
    mesh.points = std::move(points);
    for (auto n : tets) {
        const auto at = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(n[k])]; };
        if (signed_tet_volume(at(0), at(1), at(2), at(3)) < 0) std::swap(n[2], n[3]);
        mesh.nodes.insert(mesh.nodes.end(), n.begin(), n.end());
        mesh.region.push_back(0);
    }
    mesh.region_names = {"it"};
    return mesh;
}

/// A block of 4 x 4 x 4 cubes of six tets each, its inner nodes moved by up to `by`, a few of them much farther.
TetMesh shaken_block(double by) {
    constexpr int n = 4;
    std::vector<Vec3> points;
    std::uint32_t state = 5;
    const auto random = [&] {
        state = state * 1664525 + 1013904223;
        return static_cast<double>(state >> 8) / 8388608 - 1;
    };
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
            for (int k = 0; k <= n; ++k) {
                Vec3 p{double(i), double(j), double(k)};
                // Nodes on a face stay on it; those on an edge of the block move along it.
                for (std::size_t c = 0; c < 3; ++c) {
                    if (p[c] > 0 && p[c] < n) p[c] += by * random();
                }
                points.push_back(p);
            }
        }
    }
    const auto at = [](int i, int j, int k) { return (i * (n + 1) + j) * (n + 1) + k; };
    std::vector<std::array<int, 4>> tets;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            for (int k = 0; k < n; ++k) {
                const int a = at(i, j, k), g = at(i + 1, j + 1, k + 1);
                const std::array<int, 7> around{at(i + 1, j, k),     at(i + 1, j + 1, k), at(i, j + 1, k),
                                                at(i, j + 1, k + 1), at(i, j, k + 1),     at(i + 1, j, k + 1),
                                                at(i + 1, j, k)};
                for (std::size_t e = 0; e < 6; ++e) tets.push_back({a, around[e], around[e + 1], g});
            }
        }
    }
    return mesh_of_tets(std::move(points), tets);
}

}  // namespace

TEST_CASE("slivers of a distorted block are removed; its volume and faces stay") {
    const TetMesh shaken = shaken_block(0.3);
    REQUIRE(smallest_dihedral_deg(shaken) < 5);
    REQUIRE(smallest_dihedral_deg(shaken) > 0);
    TetMesh mesh = shaken;
    improve_tets(mesh, {.wanted_deg = 10});
    CHECK(smallest_dihedral_deg(mesh) > 10);
    CHECK(volume(mesh) == near(64, {.relative = 1e-9}));
    for (const Face& face : boundary_faces(mesh)) {
        bool on_side = false;
        for (std::size_t c = 0; c < 3; ++c) {
            for (const double side : {0.0, 4.0}) {
                bool all = true;
                for (std::size_t k = 0; k < 3; ++k)
                    all = all && std::fabs(mesh.points[static_cast<std::size_t>(face.nodes[k])][c] - side) < 1e-12;
                on_side = on_side || all;
            }
        }
        CHECK(on_side);
    }
}

TEST_CASE("an interface between two regions stays flat") {
    TetMesh mesh = shaken_block(0.33);
    // With an interface at x = 2, whose nodes must stay there.
    for (Vec3& p : mesh.points) {
        if (std::fabs(p.x - 2) < 0.5) p.x = 2;
    }
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        double middle = 0;
        for (const int v : mesh.tet(t)) middle += mesh.points[static_cast<std::size_t>(v)].x / 4;
        mesh.region[t] = middle > 2 ? 1 : 0;
    }
    mesh.region_names = {"left", "right"};
    REQUIRE(smallest_dihedral_deg(mesh) < 10);
    REQUIRE(smallest_dihedral_deg(mesh) > 0);
    improve_tets(mesh, {.wanted_deg = 15});
    CHECK(smallest_dihedral_deg(mesh) > 15);
    CHECK(volume(mesh, 0) == near(32, {.relative = 1e-9}));
    CHECK(volume(mesh, 1) == near(32, {.relative = 1e-9}));
}

TEST_CASE("a flat tet on a flat face is removed") {
    // A tall tet over a square, its base split so that a sliver lies below one half.
    TetMesh mesh =
        mesh_of_tets({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0.8}}, {{0, 1, 2, 4}, {0, 2, 3, 4}});
    const TetMesh good = mesh;
    improve_tets(mesh, {});
    CHECK(mesh.nodes == good.nodes);  // nothing to do
    // The same pyramid with both diagonals of its square: four nodes coplanar up to 1e-7.
    mesh.points[3].z = -1e-7;
    mesh = mesh_of_tets(mesh.points, {{0, 1, 3, 4}, {1, 2, 3, 4}, {0, 1, 2, 3}});
    REQUIRE(smallest_dihedral_deg(mesh) < 1e-3);
    improve_tets(mesh, {});
    CHECK(mesh.tet_count() == 2);
    CHECK(smallest_dihedral_deg(mesh) > 30);
    CHECK(volume(mesh) == near(0.8 / 3, {.relative = 1e-6}));
}

TEST_CASE("a good mesh is not changed, and the result is deterministic") {
    const TetMesh good = shaken_block(0);
    TetMesh mesh = good;
    improve_tets(mesh, {});
    CHECK(mesh.nodes == good.nodes);
    TetMesh one = shaken_block(0.3), other = shaken_block(0.3);
    improve_tets(one, {});
    improve_tets(other, {});
    CHECK(one.nodes == other.nodes);
    CHECK(one.points == other.points);
}
