#include "geometry/repair/surface_nesting.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "geometry/repair/surface_check.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;

namespace {

TriMesh inverted(TriMesh mesh) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

/// Volumes after orientation; 10 x 10 x 10 around 6 x 6 x 6 around 2 x 2 x 2.
const TriMesh outer = cube({0, 0, 0}, 10);
const TriMesh inner = cube({2, 2, 2}, 6);
const TriMesh core = cube({4, 4, 4}, 2);

}  // namespace

TEST_CASE("nesting: the depth of a shell decides its orientation, whichever way its faces look") {
    for (unsigned way = 0; way < 8; ++way) {
        CAPTURE(way);
        TriMesh mesh;
        for (unsigned s = 0; s < 3; ++s) {
            const TriMesh& shell = s == 0 ? core : s == 1 ? outer : inner;
            append(mesh, (way >> s & 1) != 0 ? inverted(shell) : shell);
        }
        const TurnedShells turned = orient_by_nesting(mesh);
        CHECK(signed_volume(mesh) == near(1000 - 216 + 8, {.relative = 1e-12}));
        CHECK(turned.inside_out == (way & 1) + (way >> 1 & 1));
        CHECK(turned.cavities == 1 - (way >> 2 & 1));
        CHECK(turned.triangles == 0);
        CHECK(check_closed(mesh));
    }
}

TEST_CASE("nesting: solids beside, touching and overlapping each other stay solids") {
    const TriMesh beside = joined(outer, cube({20, 0, 0}, 5));
    const TriMesh overlapping = joined(outer, cube({5, 5, 5}, 10));
    const TriMesh touching = joined(outer, cube({10, 0, 0}, 5));
    const TriMesh on_the_wall = joined(outer, cube({0, 2, 2}, 5));  // its face lies on the outer one's
    const TriMesh on_an_edge = joined(outer, cube({0, 0, 2}, 5));
    for (const TriMesh& mesh : {beside, overlapping, touching, on_the_wall, on_an_edge}) {
        TriMesh copy = mesh;
        const TurnedShells turned = orient_by_nesting(copy);
        CHECK(turned.inside_out + turned.cavities + turned.triangles == 0);
        CHECK(copy.triangles == mesh.triangles);
    }
    // Two crossing shells inside a third: embedded bodies, not a cavity.
    TriMesh crossing = joined(outer, joined(cube({2, 2, 2}, 3), cube({3, 3, 3}, 3)));
    CHECK(orient_by_nesting(crossing).cavities == 0);
}

TEST_CASE("nesting: a shell that another pierces is not nested in it") {
    // A plate with its corners inside a larger box, pierced by a needle from the box's floor.
    TriMesh box = cube({0, 0, 0}, 10);
    const int n = static_cast<int>(box.points.size());
    box.points.insert(box.points.end(), {{4.9, 4.9, 0}, {5.1, 4.9, 0}, {5, 5.1, 0}, {5, 5, 8}});
    // Floor 0-2-1, 1-2-3 is kept; the needle is a shell of its own that meets the plate.
    box.triangles.insert(box.triangles.end(),
                         {{n, n + 2, n + 1}, {n, n + 1, n + 3}, {n + 1, n + 2, n + 3}, {n + 2, n, n + 3}});
    TriMesh plate = cube({3, 3, 5}, 4);
    for (Vec3& p : plate.points) p.z = p.z > 6 ? 5.5 : 5;
    TriMesh mesh = joined(box, plate);
    CHECK(orient_by_nesting(mesh).cavities == 0);
}

TEST_CASE("nesting: flipped triangles are turned to agree with their neighbours; open shells are not changed") {
    TriMesh flipped = inverted(outer);
    std::swap(flipped.triangles[3][0], flipped.triangles[3][1]);
    std::swap(flipped.triangles[8][0], flipped.triangles[8][1]);
    const TurnedShells turned = orient_by_nesting(flipped);
    CHECK(turned.triangles == 2);
    CHECK(turned.inside_out == 1);
    CHECK(check_closed(flipped));
    TriMesh open = joined(outer, inverted(cube({20, 0, 0}, 5)));
    open.triangles.pop_back();
    const TriMesh before = open;
    const TurnedShells none = orient_by_nesting(open);
    CHECK(none.inside_out + none.cavities + none.triangles == 0);
    CHECK(open.triangles == before.triangles);
    TriMesh empty;
    CHECK(orient_by_nesting(empty).inside_out == 0);
}

TEST_CASE("nesting: a Moebius band is not changed") {
    TriMesh band;
    constexpr int steps = 12;
    for (int i = 0; i < steps; ++i) {
        const double turn = i * 2 * 3.14159265358979 / steps;
        for (const double side : {-1.0, 1.0}) {
            const double r = 5 + side * std::cos(turn / 2);
            band.points.push_back({r * std::cos(turn), r * std::sin(turn), side * std::sin(turn / 2)});
        }
    }
    for (int i = 0; i < steps; ++i) {
        const int next = i + 1 < steps ? 2 * i + 2 : 1;
        const int next_other = i + 1 < steps ? 2 * i + 3 : 0;
        band.triangles.push_back({2 * i, next, 2 * i + 1});
        band.triangles.push_back({2 * i + 1, next, next_other});
    }
    const TriMesh before = band;
    (void)orient_by_nesting(band);
    CHECK(band.triangles == before.triangles);
}
