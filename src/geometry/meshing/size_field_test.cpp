#include "geometry/meshing/size_field.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "geometry/mesh/test_shapes.hpp"

using namespace pliant;
using namespace pliant::mesh;
using pliant::mesh::test::box;

namespace {

TetMesh mesh_of(const std::vector<BodyGeometry>& bodies, const MeshSettings& settings) {
    Progress silent;
    Result<TetMesh> mesh = mesh_bodies(bodies, settings, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    return *mesh;
}

/// Mean edge length of the tets whose first corner is within `reach` of a point.
double edge_near(const TetMesh& mesh, const Vec3& p, double reach) {
    double sum = 0;
    int edges = 0;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const auto n = mesh.tet(t);
        if (norm(mesh.points[n[0]] - p) > reach) continue;
        for (const auto& [a, b] : edge_corners) {
            sum += norm(mesh.points[n[a]] - mesh.points[n[b]]);
            ++edges;
        }
    }
    REQUIRE(edges > 0);
    return sum / edges;
}

}  // namespace

TEST_CASE("wall thickness: a plate has its own; a wedge of 50 degrees has none at its edge") {
    const TriMesh plate = *tessellate(box({0, 0, 0}, {20, 20, 0.8}), 0.1);
    int thin = 0;
    for (const WallSample& wall : wall_samples(plate)) {
        const bool plate_or_side = std::fabs(wall.thickness - 0.8) < 1e-9 || std::fabs(wall.thickness - 20) < 1e-9;
        CHECK(plate_or_side);
        thin += wall.thickness < 1 ? 1 : 0;
    }
    CHECK(thin >= 4);
    PrismSolid wedge{{{0, 0}, {10, 0}, {10, 12}}, {0, 1, 2}, 0, 5};
    for (const WallSample& wall : wall_samples(*tessellate(std::make_shared<const SolidNode>(SolidNode{wedge}), 0.1)))
        CHECK(wall.thickness > 2);
}

TEST_CASE("a body may have its own mesh size, and its neighbour adapts") {
    const TetMesh mesh =
        mesh_of({{"coarse", box({0, 0, 0}, {20, 10, 10})}, {"fine", box({20, 0, 0}, {30, 10, 10}), false, 1}},
                {.size = 4, .order = 1});
    CHECK(edge_near(mesh, {27, 5, 5}, 2) < 1.4);
    CHECK(edge_near(mesh, {3, 5, 5}, 3) > 2.5);
    CHECK(volume(mesh) == near(3000, {.relative = 1e-12}));
}

TEST_CASE("the mesh is finer near a cable") {
    const TetMesh mesh = mesh_of({{"bar", box({0, 0, 0}, {40, 20, 20})}},
                                 {.size = 5, .order = 1, .size_near_cables = 1, .cables = {{{0, 3, 3}, {40, 3, 3}}}});
    CHECK(edge_near(mesh, {20, 3, 3}, 1) < 1.5);
    CHECK(edge_near(mesh, {20, 17, 17}, 6) > 2.5);
}

TEST_CASE("three elements through a wall on request; a note where a wall has fewer") {
    const std::vector<BodyGeometry> plate = {{"plate", box({0, 0, 0}, {12, 12, 1.5})}};
    const TetMesh plain = mesh_of(plate, {.size = 2, .order = 1, .judge_walls = true});
    REQUIRE(plain.notes.size() == 1);
    CHECK(plain.notes[0].find("body \"plate\": the wall at") == 0);
    CHECK(plain.notes[0].find("1.5 thick") != std::string::npos);
    const TetMesh fine = mesh_of(plate, {.size = 2, .order = 1, .through_wall = 3, .judge_walls = true});
    CHECK(fine.notes.empty());
    CHECK(edge_near(fine, {6, 6, 0.7}, 2) < 0.75);
    const TetMesh thin = mesh_of({{"foil", box({0, 0, 0}, {4, 4, 0.1})}}, {.size = 2, .order = 1, .through_wall = 3});
    REQUIRE(thin.notes.size() == 1);
    CHECK(thin.notes[0].find("too thin for 3 elements") != std::string::npos);
}
