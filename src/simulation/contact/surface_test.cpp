#include "simulation/contact/surface.hpp"

#include <doctest/doctest.h>

#include <numeric>

#include "base/core/near.hpp"
#include "simulation/contact/intersection.hpp"

using namespace pliant;
using namespace pliant::sim::contact;

namespace {

mesh::TetMesh one_tet() {
    mesh::TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.nodes = {0, 1, 2, 3};
    mesh.region = {0};
    mesh.region_names = {"all"};
    return mesh;
}

std::vector<double> positions(const mesh::TetMesh& mesh) {
    std::vector<double> x;
    for (const Vec3& p : mesh.points) x.insert(x.end(), {p.x, p.y, p.z});
    return x;
}

}  // namespace

TEST_CASE("the surface of a tet has the right faces, edges and points, linear and quadratic") {
    const Surface linear = robot_surface(one_tet());
    CHECK(linear.triangles.size() == 4);
    CHECK(linear.edges.size() == 6);
    CHECK(linear.points == std::vector<int>{0, 1, 2, 3});
    const Surface quadratic = robot_surface(mesh::to_quadratic(one_tet()));
    CHECK(quadratic.triangles.size() == 16);
    CHECK(quadratic.edges.size() == 24);
    CHECK(quadratic.points.size() == 10);
}

TEST_CASE("triangles of quadratic faces are oriented outwards: they enclose the tet's volume") {
    const mesh::TetMesh mesh = mesh::to_quadratic(one_tet());
    mesh::TriMesh closed{mesh.points, robot_surface(mesh).triangles};
    CHECK(mesh::signed_volume(closed) == near(1.0 / 6, {.relative = 1e-12}));
}

TEST_CASE("the areas of points, edges and triangles each sum to the whole surface") {
    for (const mesh::TetMesh& mesh : {one_tet(), mesh::to_quadratic(one_tet())}) {
        const SurfaceAreas areas = surface_areas(robot_surface(mesh), positions(mesh));
        const double whole = 1.5 + std::sqrt(3.0) / 2;
        CHECK(std::accumulate(areas.points.begin(), areas.points.end(), 0.0) == near(whole, {.relative = 1e-12}));
        CHECK(std::accumulate(areas.edges.begin(), areas.edges.end(), 0.0) == near(whole, {.relative = 1e-12}));
        CHECK(std::accumulate(areas.triangles.begin(), areas.triangles.end(), 0.0) == near(whole, {.relative = 1e-12}));
    }
}

TEST_CASE("a segment crosses a triangle only through its interior") {
    const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
    CHECK(segment_crosses_triangle({0.2, 0.2, -1}, {0.3, 0.2, 1}, a, b, c));
    CHECK(segment_crosses_triangle({0.3, 0.2, 1}, {0.2, 0.2, -1}, a, b, c));
    CHECK_FALSE(segment_crosses_triangle({0.2, 0.2, 0.1}, {0.3, 0.2, 1}, a, b, c));
    CHECK_FALSE(segment_crosses_triangle({0.8, 0.8, -1}, {0.8, 0.8, 1}, a, b, c));
    CHECK_FALSE(segment_crosses_triangle({0.2, 0.2, 0}, {0.3, 0.2, 1}, a, b, c));
    CHECK_FALSE(segment_crosses_triangle({-1, 0.5, 0}, {1, 0.5, 0}, a, b, c));
}
