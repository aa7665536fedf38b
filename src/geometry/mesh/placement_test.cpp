#include "geometry/mesh/placement.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "base/core/near.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "geometry/mesh/test_tets.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

bool same_point(const Vec3& a, const Vec3& b) {
    return norm(a - b) < 1e-12;
}

RigidMotion quarter_turn() {
    return {std::numbers::pi / 2, {0, 0, 2}, {1, 0, 0}, {0, 0, 5}};
}

}  // namespace

TEST_CASE("a point is scaled, mirrored, rotated and moved, in this order") {
    Placement placement;
    placement.scale = 2;
    CHECK(same_point(place({1, 2, 3}, placement), {2, 4, 6}));
    placement.mirror_normal = {3, 0, 0};
    placement.mirror_point = {1, 7, 7};
    CHECK(same_point(place({1, 2, 3}, placement), {0, 4, 6}));
    placement.motion = quarter_turn();  // about the line x = 1, y = 0: (0, 4) is (-1, 4) from it
    CHECK(same_point(place({1, 2, 3}, placement), {1 - 4, -1, 6 + 5}));
}

TEST_CASE("a mirrored surface keeps its outside, and its copies are repeated") {
    Placement placement;
    placement.scale = 0.5;
    placement.mirror_normal = {1, 1, 0};
    placement.count = 3;
    placement.step.shift = {0, 0, 20};
    const TriMesh cubes = placed(test::cube(), placement);
    CHECK(cubes.triangles.size() == 3 * test::cube().triangles.size());
    CHECK(signed_volume(cubes) == near(3 * 125, {.relative = 1e-12}));
    CHECK(same_point(bounds(cubes).low, {-5, -5, 0}));
    CHECK(same_point(bounds(cubes).high, {0, 0, 45}));
}

TEST_CASE("mirrored tets stay positive and keep their regions, linear and quadratic") {
    Placement placement;
    placement.mirror_normal = {0, 0, 1};
    placement.count = 4;
    placement.step = quarter_turn();
    for (const TetMesh& mesh : {test::two_tets(), to_quadratic(test::two_tets())}) {
        const TetMesh copies = placed(mesh, placement);
        REQUIRE(copies.tet_count() == 4 * mesh.tet_count());
        CHECK(volume(copies) == near(4 * volume(mesh), {.relative = 1e-12}));
        CHECK(volume(copies, 1) == near(4 * volume(mesh, 1), {.relative = 1e-12}));
        for (std::size_t t = 0; t < copies.tet_count(); ++t) {
            const auto n = copies.tet(t);
            const auto at = [&](std::size_t k) { return copies.points[static_cast<std::size_t>(n[k])]; };
            CHECK(signed_tet_volume(at(0), at(1), at(2), at(3)) > 0);
            for (std::size_t e = 0; copies.order == 2 && e < edge_corners.size(); ++e) {
                const auto [a, b] = edge_corners[e];
                CHECK(same_point(at(4 + e), 0.5 * (at(static_cast<std::size_t>(a)) + at(static_cast<std::size_t>(b)))));
            }
        }
    }
}
