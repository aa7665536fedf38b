#include "presentation/draw/surface.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "base/core/near.hpp"
#include "presentation/draw/tube.hpp"
#include "presentation/report/test_robot.hpp"

using namespace pliant;
using namespace pliant::report;

namespace {

double area(const Surface& surface, const Pose& pose, int material) {
    double sum = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        if (surface.material[t] != material) continue;
        const auto& n = surface.triangles[t];
        const auto at = [&](std::size_t k) { return pose.positions[static_cast<std::size_t>(n[k])]; };
        sum += 0.5 * norm(cross(at(1) - at(0), at(2) - at(0)));
    }
    return sum;
}

}  // namespace

TEST_CASE("the outer surface of the bar has the right area per material, whatever the order of the tets") {
    for (const int order : {1, 2}) {
        const auto robot = report::test::bent_bar(1, order);
        const std::vector<int> materials = {0, 1};
        const Surface surface = outer_surface(robot.mesh, materials);
        const Pose rest = pose(surface, robot.mesh.points);
        CHECK(area(surface, rest, 0) == near(0.06 * 2 * 0.035 + 0.02 * 0.015, {.relative = 1e-12}));
        CHECK(area(surface, rest, 1) == near(0.04 * 2 * 0.035 + 0.02 * 0.015, {.relative = 1e-12}));
    }
}

TEST_CASE("a face next to a void belongs to the material's surface; the void has none") {
    const auto robot = report::test::bent_bar(1, 1);
    const std::vector<int> materials = {0, -1};
    const Surface surface = outer_surface(robot.mesh, materials);
    const Pose rest = pose(surface, robot.mesh.points);
    CHECK(area(surface, rest, 0) == near(0.06 * 2 * 0.035 + 2 * 0.02 * 0.015, {.relative = 1e-12}));
    CHECK(std::all_of(surface.tet.begin(), surface.tet.end(),
                      [&](int t) { return robot.mesh.region[static_cast<std::size_t>(t)] == 0; }));
}

TEST_CASE("normals of a box are those of its faces, also after a rotation") {
    const auto robot = report::test::bent_bar(1, 2);
    const std::vector<int> materials = {0, 0};
    const Surface surface = outer_surface(robot.mesh, materials);
    std::vector<Vec3> turned = robot.mesh.points;
    for (Vec3& p : turned) p = {p.z, p.x, p.y};
    for (const auto& positions : {robot.mesh.points, turned}) {
        for (const Vec3& n : pose(surface, positions).normals) {
            CHECK(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) == near(1, {.relative = 1e-12}));
        }
    }
    // Twelve cube edges' nodes are doubled, eight corners tripled: faces of 41 x 9, 41 x 7, 9 x 7 nodes.
    CHECK(surface.vertex_node.size() == 2 * (41 * 9 + 41 * 7 + 9 * 7));
}

TEST_CASE("values of tets are averaged at vertices within their own material only") {
    const auto robot = report::test::bent_bar(1, 1);
    const std::vector<int> materials = {0, 1};
    const Surface surface = outer_surface(robot.mesh, materials);
    std::vector<double> values;
    for (const int region : robot.mesh.region) values.push_back(region == 0 ? 3 : 8);
    const auto at = at_vertices(robot.mesh, materials, surface, values);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        for (const int v : surface.triangles[t]) {
            CHECK(at[static_cast<std::size_t>(v)] == near(surface.material[t] == 0 ? 3 : 8, {.relative = 1e-12}));
        }
    }
}

TEST_CASE("a tube around a line is closed and has the given radius") {
    const std::vector<Vec3> line = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}};
    const Tube tube = tube_around(line, 0.1);
    mesh::TriMesh surface{tube.positions, tube.triangles};
    CHECK(mesh::signed_volume(surface) > 0);
    CHECK(mesh::bounds(surface).low.z == near(-0.1, {.relative = 1e-12}));
    for (const Vec3& n : tube.normals) CHECK(norm(n) == near(1, {.relative = 1e-12}));
    const Tube straight = tube_around(std::vector<Vec3>{{0, 0, 0}, {0, 0, 2}}, 0.5);
    const double decagon = 10 * 0.5 * 0.5 * 0.5 * std::sin(0.2 * 3.14159265358979);
    CHECK(mesh::signed_volume({straight.positions, straight.triangles}) == near(2 * decagon, {.relative = 1e-12}));
}

TEST_CASE("a rigid box has flat faces: each corner vertex is split in three") {
    mesh::TriMesh box;
    for (int i = 0; i < 8; ++i) box.points.push_back({1.0 * (i & 1), 1.0 * (i >> 1 & 1), 1.0 * (i >> 2)});
    box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    const Surface surface = rigid_surface(box);
    CHECK(surface.triangles.size() == 12);
    CHECK(surface.vertex_node.size() == 24);
    const Pose at_rest = pose(surface, box.points);
    for (std::size_t v = 0; v < 24; ++v) {
        const Vec3 n = at_rest.normals[v], out = at_rest.positions[v] - Vec3{0.5, 0.5, 0.5};
        CHECK(std::abs(n.x) + std::abs(n.y) + std::abs(n.z) == near(1, {.relative = 1e-12}));  // along an axis
        CHECK(dot(n, out) == near(0.5, {.relative = 1e-12}));
    }
}
