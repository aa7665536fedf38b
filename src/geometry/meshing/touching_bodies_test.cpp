// Surfaces of many faces that touch or overlap other bodies.
#include "geometry/meshing/touching_bodies.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/core/near.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/mesh/test_shapes.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;

namespace {

constexpr double pi = std::numbers::pi;

TriMesh fine(const Solid& solid, double tolerance) {
    Result<TriMesh> surface = tessellate(solid, tolerance);
    REQUIRE(surface);
    REQUIRE(surface->triangles.size() > 1000);
    return *surface;
}

TetMesh sliver_free_mesh(const std::vector<BodyGeometry>& bodies, double size, int order = 1) {
    Progress silent;
    Result<TetMesh> mesh = mesh_bodies(bodies, {.size = size, .order = order}, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(report_on(*mesh).min_dihedral_deg > 5);
    return *mesh;
}

/// Total area of the faces with a tet on one side only.
double outer_area(const TetMesh& mesh) {
    double sum = 0;
    for (const Face& face : boundary_faces(mesh)) {
        const auto at = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(face.nodes[k])]; };
        sum += norm(cross(at(1) - at(0), at(2) - at(0))) / 2;
    }
    return sum;
}

}  // namespace

TEST_CASE("a ball in a matching hole, triangulated differently, gives one mesh with its block") {
    const Solid ball = solid(SphereSolid{{10, 10, 10}, 6});
    const Solid block = without(box({0, 0, 0}, {20, 20, 20}), ball);
    const TetMesh mesh = sliver_free_mesh({{"block", fine(block, 0.03)}, {"ball", fine(ball, 0.01), false, 1.5}}, 3);
    CHECK(mesh.region_names == std::vector<std::string>{"block", "ball"});
    CHECK(volume(mesh, 0) == near(8000 - 288 * pi, {.relative = 0.01}));
    CHECK(volume(mesh, 1) == near(288 * pi, {.relative = 0.03}));  // chords of 1.5 around a radius of 6
    CHECK(outer_area(mesh) == near(2400, {.relative = 1e-3}));
    REQUIRE(mesh.notes.size() == 1);
    CHECK(mesh.notes[0].starts_with("bodies that touch were meshed together from their winding numbers"));
    CHECK(mesh.notes[0].find("body \"ball\" ") != std::string::npos);
    // The ball's own mesh size is used.
    const TetMesh coarse = sliver_free_mesh({{"block", fine(block, 0.03)}, {"ball", fine(ball, 0.01)}}, 3);
    const auto tets = [](const TetMesh& m) { return std::count(m.region.begin(), m.region.end(), 1); };
    CHECK(tets(mesh) > 3 * tets(coarse));
}

TEST_CASE("an overlap of a drawn solid and a surface goes to the later one; separate bodies stay separate") {
    const TriMesh ball = fine(solid(SphereSolid{{7, 5, 5}, 4}), 0.005);
    const double cap = pi * (12 - 1) / 3;
    const BodyGeometry drawn{"drawn", box({10, 0, 0}, {20, 10, 10})};
    const TetMesh drawn_last = sliver_free_mesh({{"ball", ball}, drawn}, 2);
    CHECK(volume(drawn_last, 0) == near(256 * pi / 3 - cap, {.relative = 0.05}));  // chords of 2 around 4
    CHECK(volume(drawn_last, 1) == near(1000, {.relative = 0.01}));
    const TetMesh ball_last = sliver_free_mesh({drawn, {"ball", ball}}, 2, 2);
    CHECK(volume(ball_last, 0) == near(1000 - cap, {.relative = 0.01}));
    CHECK(ball_last.order == 2);
    const double whole = 600 + 64 * pi;
    const double covered = 2 * (7 * pi);  // the circle of intersection
    CHECK(outer_area(drawn_last) == near(whole - covered - 8 * pi + 7 * pi, {.relative = 0.03}));

    const TetMesh apart = sliver_free_mesh({drawn, {"ball", fine(solid(SphereSolid{{5, 5, 5}, 4}), 0.005)}}, 2);
    REQUIRE(apart.notes.size() == 1);  // nothing was joined
    CHECK(apart.notes[0].find("its mesh has a volume of") != std::string::npos);
    CHECK(outer_area(apart) == near(whole, {.relative = 0.02}));
}

TEST_CASE("a body of a surface that later ones cover is refused by name") {
    const TriMesh ball = fine(solid(SphereSolid{{5, 5, 5}, 3}), 0.005);
    const std::vector<BodyGeometry> bodies{
        {"ball", ball}, {"left", box({0, 0, 0}, {5, 10, 10})}, {"right", box({5, 0, 0}, {10, 10, 10})}};
    Progress silent;
    const auto covered = mesh_bodies(bodies, {.size = 2, .order = 1}, silent);
    REQUIRE_FALSE(covered);
    CHECK(covered.error().message.starts_with("body \"ball\" is empty: all of it belongs to later ones"));
}

TEST_CASE("a group holds all bodies that touch, and no other") {
    const TriMesh ball = fine(solid(SphereSolid{{5, 5, 14}, 4}), 0.005);  // standing on the first box
    const std::vector<BodyGeometry> bodies{{"alone", box({50, 0, 0}, {60, 10, 10})},
                                           {"foot", box({0, 0, 0}, {10, 10, 10.02})},
                                           {"beside", box({10, 0, 0}, {20, 10, 10})},
                                           {"ball", ball}};
    const auto groups = touching_groups(bodies, 2);
    REQUIRE(groups);
    REQUIRE(groups->size() == 1);
    CHECK(groups->front().bodies == std::vector<std::size_t>{1, 2, 3});
    CHECK(groups->front().surfaces.size() == 3);
    CHECK(touching_groups(std::span(bodies).first(3), 2)->empty());
}

TEST_CASE("a surface that encloses nothing is refused by name") {
    TriMesh sheet;
    constexpr int side = 24;
    for (int i = 0; i <= side; ++i) {
        for (int j = 0; j <= side; ++j) {
            sheet.points.push_back({0.3 * i, 0.3 * j, 5});
            const int n = i * (side + 1) + j;
            if (i == side || j == side) continue;
            sheet.triangles.push_back({n, n + side + 1, n + 1});
            sheet.triangles.push_back({n + 1, n + side + 1, n + side + 2});
        }
    }
    Progress silent;
    const auto mesh = mesh_bodies(std::vector<BodyGeometry>{{"box", box({0, 0, 0}, {10, 10, 10})}, {"sheet", sheet}},
                                  {.size = 2, .order = 1}, silent);
    REQUIRE_FALSE(mesh);
    CHECK(mesh.error().message.starts_with("body \"sheet\" encloses nothing: it is an open sheet"));
}
