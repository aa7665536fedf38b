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

TEST_CASE("the surface of something rigid has no edges inside its flat faces") {
    // A unit cube of two triangles a face, of which one has a corner in its middle, and a bent one.
    const auto edges = [](double middle_z) {
        const std::vector<double> x{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1,   0,   0,       0,
                                    1, 1, 0, 1, 1, 1, 1, 0, 1, 1, 0.4, 0.5, middle_z};
        const std::vector<std::array<int, 3>> triangles{{0, 2, 1}, {0, 3, 2}, {0, 1, 5}, {0, 5, 4}, {1, 2, 6},
                                                        {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7},
                                                        {4, 5, 8}, {5, 6, 8}, {6, 7, 8}, {7, 4, 8}};
        const Surface surface = make_rigid_surface(triangles, x);
        CHECK(surface.triangles.size() == 14);
        CHECK(surface.points.size() == 9);
        for (std::size_t p = 0; p < 9; ++p) CHECK(surface.acts(p) == (p < 8 || middle_z != 1));
        const SurfaceAreas areas = surface_areas(surface, x);
        CHECK(std::accumulate(areas.edges.begin(), areas.edges.end(), 0.0) ==
              near(std::accumulate(areas.points.begin(), areas.points.end(), 0.0), {.relative = 1e-12}));
        for (std::size_t t = 0; t < 10; ++t) CHECK(areas.triangles[t] == near(1, {.relative = 1e-12}));
        for (std::size_t t = 0; t < 14; ++t)
            for (std::size_t other = 0; other < t; ++other) {
                const bool same_side = t < 10 ? t / 2 == other / 2 : other >= 10 && middle_z == 1;
                CHECK((surface.flat_face[t] >= 0 && surface.flat_face[t] == surface.flat_face[other]) == same_side);
            }
        return surface.edges.size();
    };
    CHECK(edges(1) == 12);
    CHECK(edges(1.01) == 16);
    CHECK(edges(0.99) == 16);
    // A sheet of two triangles that are folded onto each other.
    CHECK(make_rigid_surface(std::vector<std::array<int, 3>>{{0, 1, 2}, {1, 0, 3}},
                             std::vector<double>{0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.5, 0.8, 0})
              .edges.size() == 5);
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
