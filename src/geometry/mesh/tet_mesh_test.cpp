#include "geometry/mesh/tet_mesh.hpp"

#include <doctest/doctest.h>

#include <numeric>

#include "base/core/near.hpp"
#include "geometry/mesh/test_tets.hpp"

using namespace pliant;
using namespace pliant::mesh;
using mesh::test::two_tets;

TEST_CASE("volumes of regions") {
    const TetMesh mesh = two_tets();
    CHECK(volume(mesh, 0) == near(1.0 / 6, {.relative = 1e-12}));
    CHECK(volume(mesh, 1) == near(1.0 / 3, {.relative = 1e-12}));
    CHECK(volume(mesh) == near(0.5, {.relative = 1e-12}));
}

TEST_CASE("the boundary leaves out shared faces and looks outwards") {
    for (const TetMesh& mesh : {two_tets(), to_quadratic(two_tets())}) {
        const auto faces = boundary_faces(mesh);
        CHECK(faces.size() == 6);
        TriMesh surface;
        surface.points = mesh.points;
        for (const Face& face : faces) surface.triangles.push_back({face.nodes[0], face.nodes[1], face.nodes[2]});
        CHECK(signed_volume(surface) == near(0.5, {.relative = 1e-12}));
        for (const Face& face : faces) {
            for (int i = 0; i < 3 && mesh.order == 2; ++i) {
                const Vec3 middle = 0.5 * (mesh.points[face.nodes[i]] + mesh.points[face.nodes[(i + 1) % 3]]);
                CHECK(norm(mesh.points[face.nodes[3 + i]] - middle) < 1e-15);
            }
        }
    }
}

TEST_CASE("tets that overlap are found by the face that they share") {
    using Pair = std::array<int, 2>;
    for (const int order : {1, 2}) {
        const auto raised = [&](const TetMesh& mesh) { return order == 2 ? to_quadratic(mesh) : mesh; };
        CHECK_FALSE(overlapping_tets(raised(two_tets())));
        TetMesh twice = two_tets();
        twice.nodes.insert(twice.nodes.end(), {2, 0, 1, 3});  // the first one again, its corners rotated
        twice.region.push_back(0);
        const auto same = overlapping_tets(raised(twice));
        REQUIRE(same);
        CHECK((same->same && Pair{same->first, same->second} == Pair{0, 2}));
        CHECK(overlap_text(*same) == "tetrahedra 0 and 2 are the same");
        TetMesh same_side = two_tets();
        same_side.points[4] = {-0.5, -0.5, -0.5};  // the second tet folded over the first
        reverse_tet(std::span(same_side.nodes).subspan(4));
        const auto folded = overlapping_tets(raised(same_side));
        REQUIRE(folded);
        CHECK((!folded->same && Pair{folded->first, folded->second} == Pair{0, 1}));
    }
}

TEST_CASE("of many tets on one side of a face the lowest same pair is told") {
    TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (int apex = 3; apex < 9; ++apex) {
        mesh.points.push_back({0.1 * apex, 0.1, 1.0});
        mesh.nodes.insert(mesh.nodes.end(), {0, 1, 2, apex});
        mesh.region.push_back(0);
    }
    mesh.region_names = {"all"};
    CHECK(overlap_text(overlapping_tets(mesh).value()).starts_with("tetrahedra 0 and 1 overlap"));
    for (int copy = 0; copy < 20000; ++copy) {  // too many to compare each with each
        mesh.nodes.insert(mesh.nodes.end(), {1, 2, 0, copy % 2 == 0 ? 7 : 5});
        mesh.region.push_back(0);
    }
    CHECK(overlap_text(overlapping_tets(mesh).value()) == "tetrahedra 2 and 7 are the same");
}

TEST_CASE("the surface of one region is closed") {
    CHECK(signed_volume(region_surface(two_tets(), 1)) == near(1.0 / 3, {.relative = 1e-12}));
    CHECK(signed_volume(region_surface(to_quadratic(two_tets()), 0)) == near(1.0 / 6, {.relative = 1e-12}));
    CHECK(region_surface(two_tets(), 0).points.size() == 4);
}

TEST_CASE("a quadratic mesh shares its mid-edge nodes") {
    const TetMesh mesh = to_quadratic(two_tets());
    CHECK(mesh.points.size() == 5 + 9);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const auto n = mesh.tet(t);
        for (std::size_t e = 0; e < 6; ++e) {
            const Vec3 middle = 0.5 * (mesh.points[n[edge_corners[e][0]]] + mesh.points[n[edge_corners[e][1]]]);
            CHECK(norm(mesh.points[n[4 + e]] - middle) < 1e-15);
        }
    }
}

TEST_CASE("shape functions sum to one and are one at their own node") {
    for (const int order : {1, 2}) {
        const auto inside = shape_functions(order, {0.1, 0.2, 0.3, 0.4});
        CHECK(std::accumulate(inside.begin(), inside.end(), 0.0) == near(1, {.relative = 1e-12}));
    }
    CHECK(shape_functions(2, {0, 0, 1, 0})[2] == 1);
    CHECK(shape_functions(2, {0, 0.5, 0.5, 0})[5] == 1);
}

TEST_CASE("the volume of a surface far from the origin keeps its digits") {
    TriMesh surface = region_surface(two_tets(), 0);
    for (Vec3& p : surface.points) p += Vec3{1e6, 1e6, 1e6};
    CHECK(signed_volume(surface) == near(1.0 / 6, {.relative = 1e-9}));
    CHECK(bounds(surface).size().x == near(1, {.relative = 1e-12}));
}
