#include "geometry/repair/surface_slivers.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "base/core/progress.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "geometry/mesher/mesher.hpp"
#include "geometry/repair/surface_check.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;

namespace {

/// Inserts `count` points into the first edge of a triangle, on this side only: a fan of triangles without area fills
/// the gap to the neighbour's unsplit edge.
void split_edge(TriMesh& mesh, std::size_t triangle, int count) {
    const auto [a, b, c] = mesh.triangles[triangle];
    const Vec3 from = mesh.points[a];
    const Vec3 along = mesh.points[b] - from;
    int last = a;
    for (int k = 1; k <= count; ++k) {
        const int fresh = static_cast<int>(mesh.points.size());
        mesh.points.push_back(from + (static_cast<double>(k) / (count + 1)) * along);
        if (k == 1)
            mesh.triangles[triangle] = {a, fresh, c};
        else
            mesh.triangles.push_back({last, fresh, c});
        mesh.triangles.push_back({last, b, fresh});
        last = fresh;
    }
    mesh.triangles.push_back({last, b, c});
}

/// A point inside the bottom, 2e-4 from corner 0: two triangles of edge 10 and height 1.4e-4.
TriMesh with_needles() {
    TriMesh mesh = cube({0, 0, 0}, 10);
    mesh.points.push_back({2e-4, 2e-4, 0});
    mesh.triangles[0] = {0, 2, 8};
    mesh.triangles.push_back({2, 1, 8});
    mesh.triangles.push_back({1, 0, 8});
    return mesh;
}

}  // namespace

TEST_CASE("flat triangles are removed and the shape stays") {
    for (const int points : {1, 2, 7}) {
        CAPTURE(points);
        TriMesh mesh = cube({0, 0, 0}, 10);
        split_edge(mesh, 3, points);
        REQUIRE(check_closed(mesh));
        const SliverCount count = remove_slivers(mesh);
        CHECK(count.removed == static_cast<std::size_t>(points));
        CHECK(count.left == 0);
        CHECK(check_closed(mesh));
        CHECK(signed_volume(mesh) == near(1000, {.relative = 1e-12}));
        CHECK(remove_slivers(mesh).removed == 0);
    }
}

TEST_CASE("triangles with two equal corners go") {
    TriMesh mesh = cube({0, 0, 0}, 10);
    mesh.triangles.push_back({0, 0, 5});
    mesh.triangles.push_back({5, 6, 5});
    CHECK(remove_slivers(mesh).removed == 2);
    CHECK(check_closed(mesh));
    CHECK(mesh.triangles.size() == 12);
}

TEST_CASE("a needle between two close points is kept and counted, and the body is meshed") {
    TriMesh mesh = with_needles();
    REQUIRE(check_closed(mesh));
    const SliverCount count = remove_slivers(mesh);
    CHECK(count.removed == 0);
    CHECK(count.left == 2);
    CHECK(check_closed(mesh));
    CHECK(signed_volume(mesh) == near(1000, {.relative = 1e-12}));

    Progress silent;
    const Result<TetMesh> tets = mesh_bodies(std::vector<BodyGeometry>{{"b", mesh}}, {.size = 4}, silent);
    REQUIRE_MESSAGE(tets, (tets ? "" : tets.error().message));
    CHECK(volume(*tets) == near(1000, {.relative = 1e-12}));
    REQUIRE(tets->notes.size() == 1);
    CHECK(tets->notes.front().find("body \"b\": the surface keeps the triangles that it was drawn with") == 0);
    CHECK(smallest_dihedral_deg(*tets) > 5);
}

TEST_CASE("a body with flat triangles is remeshed, with a note") {
    TriMesh mesh = cube({0, 0, 0}, 10);
    split_edge(mesh, 3, 1);
    Progress silent;
    const Result<TetMesh> tets = mesh_bodies(std::vector<BodyGeometry>{{"b", mesh}}, {.size = 4}, silent);
    REQUIRE_MESSAGE(tets, (tets ? "" : tets.error().message));
    CHECK(volume(*tets) == near(1000, {.relative = 1e-12}));
    REQUIRE(tets->notes.size() == 1);
    CHECK(tets->notes.front().find("body \"b\": 1 flat triangle") == 0);
}
