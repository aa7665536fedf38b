#include "geometry/meshing/winding_mesher.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "base/core/near.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "geometry/mesh/triangle_tree.hpp"
#include "geometry/meshing/sharp_edges.hpp"
#include "geometry/repair/surface_orientation.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;

namespace {

Progress silent;

/// A convex or slightly concave outline, counter-clockwise in x and y, extruded along z.
TriMesh extruded(const std::vector<std::array<double, 2>>& outline, double height) {
    TriMesh mesh;
    const int n = static_cast<int>(outline.size());
    for (const double z : {0.0, height}) {
        for (const auto& [x, y] : outline) mesh.points.push_back({x, y, z});
    }
    for (int i = 0; i < n; ++i) {
        const int j = (i + 1) % n;
        mesh.triangles.push_back({i, j, n + j});
        mesh.triangles.push_back({i, n + j, n + i});
        if (i < 1 || j == 0) continue;
        mesh.triangles.push_back({0, j, i});
        mesh.triangles.push_back({n, n + i, n + j});
    }
    return mesh;
}

double length(const std::vector<Vec3>& chain) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) sum += norm(chain[i + 1] - chain[i]);
    return sum;
}

/// The mesh's volume; checks that its tets are usable.
double meshed_volume(const TriMesh& surface, double size) {
    const Result<TetMesh> mesh = mesh_by_winding(surface, size, 30, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(report_on(*mesh).min_dihedral_deg > 5);
    CHECK(mesh->notes.size() == 1);
    return volume(*mesh);
}

}  // namespace

TEST_CASE("winding number: 1 inside, 0 outside, 2 in an overlap, and the solid angle of one triangle") {
    const TriangleTree tree(cube());
    CHECK(tree.winding_number({5, 5, 5}) == near(1, {.relative = 1e-12}));
    CHECK(tree.winding_number({1e-3, 9, 1}) == near(1, {.relative = 1e-12}));
    CHECK(std::fabs(tree.winding_number({11, 5, 5})) < 1e-12);
    CHECK(std::fabs(tree.winding_number({500, 5, 5})) < 1e-6);
    const TriangleTree twice(joined(cube(), cube({5, 0, 0})));
    CHECK(twice.winding_number({7, 5, 5}) == near(2, {.relative = 1e-12}));
    TriMesh octant{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}}};
    CHECK(TriangleTree(octant).winding_number({0, 0, 0}) == near(1.0 / 8, {.relative = 1e-12}));
}

TEST_CASE("a ray hits the nearest triangle") {
    const TriangleTree tree(joined(cube(), cube({20, 0, 0})));
    const auto hit = tree.first_hit({-3, 5, 4}, {1, 0, 0}, 0);
    REQUIRE(hit);
    CHECK(hit->distance == near(3, {.relative = 1e-12}));
    CHECK(tree.first_hit({-3, 5, 4}, {1, 0, 0}, 3.5)->distance == near(13, {.relative = 1e-12}));
    CHECK_FALSE(tree.first_hit({-3, 5, 40}, {1, 0, 0}, 0));
}

TEST_CASE("orientation: flipped triangles are turned; repeated and flat ones are removed") {
    TriMesh flipped = cube();
    std::swap(flipped.triangles[3][0], flipped.triangles[3][1]);
    flipped.triangles.push_back(flipped.triangles[5]);
    flipped.triangles.push_back({1, 1, 2});
    SurfaceDamage damage = orient(flipped);
    CHECK(damage.turned == 1);
    CHECK(damage.repeated == 1);
    CHECK(damage.flat == 1);
    CHECK(damage.open_edges + damage.crowded_edges == 0);
    CHECK(signed_volume(flipped) == near(1000, {.relative = 1e-12}));
    TriMesh inwards = cube();
    for (auto& t : inwards.triangles) std::swap(t[0], t[1]);
    CHECK(orient(inwards).inside_out);
    CHECK(signed_volume(inwards) == near(1000, {.relative = 1e-12}));
}

TEST_CASE("holes, flipped facets, overlaps and close edges are meshed with their volume and sharp edges") {
    TriMesh hole = cube();
    hole.triangles.pop_back();
    CHECK(meshed_volume(hole, 2) == near(1000, {.relative = 0.02}));
    TriMesh flipped = cube();
    std::swap(flipped.triangles[3][0], flipped.triangles[3][1]);
    CHECK(meshed_volume(flipped, 2) == near(1000, {.relative = 1e-3}));
    CHECK(meshed_volume(joined(cube(), cube({5, 5, 5})), 2) == near(1875, {.relative = 0.02}));
    TriMesh rooms = cube();
    TriMesh room = cube({3, 3, 3}, 4);
    for (auto& t : room.triangles) std::swap(t[0], t[1]);
    CHECK(meshed_volume(joined(rooms, room), 2) == near(936, {.relative = 0.01}));
    CHECK(meshed_volume(cube({1e6, 0, 0}), 2) == near(1000, {.relative = 1e-3}));
}

TEST_CASE("the same surface gives the same mesh; one that encloses nothing is refused") {
    TriMesh hole = cube();
    hole.triangles.pop_back();
    const Result<TetMesh> first = mesh_by_winding(hole, 3, 30, silent);
    const Result<TetMesh> second = mesh_by_winding(hole, 3, 30, silent);
    REQUIRE(first);
    REQUIRE(second);
    CHECK(first->points == second->points);
    CHECK(first->nodes == second->nodes);
    CHECK(first->notes[0].find("3 open edges") != std::string::npos);
    const TriMesh sheet{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    CHECK(mesh_by_winding(sheet, 0.1, 30, silent).error().message.find("encloses nothing") != std::string::npos);
    CHECK(mesh_by_winding({}, 0.1, 30, silent).error().message.find("encloses nothing") != std::string::npos);
    CHECK(mesh_by_winding(hole, 1e-3, 30, silent).error().message.find("more than the") != std::string::npos);
}

TEST_CASE("sharp edges that cross or nearly touch are left out, so that the mesher terminates") {
    // Two intersecting bars: their edges cross each other's faces, and their top faces are coplanar.
    TriMesh along = cube({0, 0, 0}, 1);
    TriMesh across = along;
    for (Vec3& p : along.points) p = {20 * p.x, 8 + 4 * p.y, 4 * p.z};
    for (Vec3& p : across.points) p = {8 + 4 * p.x, 20 * p.y, 4 * p.z};
    const TriMesh cross = joined(along, across);
    const SharpEdges edges = sharp_edges(LabelledSpace({cross}), 2, 30);
    CHECK(edges.dropped >= 8);
    CHECK_FALSE(edges.chains.empty());
    const Result<TetMesh> mesh = mesh_by_winding(cross, 2, 30, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(volume(*mesh) == near(2 * 320 - 64, {.relative = 0.02}));
    CHECK(report_on(*mesh).min_dihedral_deg > 5);
    const SharpEdges clean = sharp_edges(LabelledSpace({cube()}), 2, 30);
    CHECK(clean.dropped == 0);
    CHECK(clean.chains.size() == 12);
}

TEST_CASE("edges closer than the mesh size are merged; edges that part at a small angle are left out") {
    constexpr double size = 2;
    const TriMesh step = extruded({{0, 0}, {10, 0}, {10, 10}, {5, 10}, {5, 10.002}, {0, 10.002}}, 10);
    const SharpEdges edges = sharp_edges(LabelledSpace({step}), size, 30);
    CHECK(edges.dropped == 0);
    CHECK(edges.chains.size() == 5 + 5 + 5);
    for (const auto& chain : edges.chains) CHECK(length(chain) > 0.1 * size);
    const Result<TetMesh> mesh = mesh_by_winding(step, size, 30, silent);
    REQUIRE(mesh);
    CHECK(mesh->notes.size() == 1);
    CHECK(mesh->tet_count() < 2 * mesh_by_winding(cube(), size, 30, silent)->tet_count());
    CHECK(volume(*mesh) == near(1000.01, {.relative = 1e-3}));

    const TriMesh wedge = extruded({{0, 0}, {10, 0}, {10, 0.5}}, 10);
    const SharpEdges acute = sharp_edges(LabelledSpace({wedge}), size, 30);
    CHECK(acute.dropped == 4);
    CHECK_FALSE(acute.chains.empty());
    const TriMesh roof = extruded({{0, 0}, {10, 0}, {10, 5}}, 10);
    CHECK(sharp_edges(LabelledSpace({roof}), size, 30).dropped == 0);
}

TEST_CASE("a mesh size too coarse for the surface is reduced, with a note") {
    TriMesh frame = cube({0, 0, 0}, 20);
    TriMesh room = cube({2, 2, -5}, 16);
    for (auto& t : room.triangles) std::swap(t[0], t[1]);
    for (Vec3& p : frame.points) p.z *= 0.1;
    for (Vec3& p : room.points) p.z = p.z < 0 ? 0 : 2;
    // The lids of frame and room are coplanar with opposite orientation.
    const Result<TetMesh> mesh = mesh_by_winding(joined(frame, room), 9, 180, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(volume(*mesh) == near(2 * (400 - 256), {.relative = 0.1}));
    CHECK(mesh->notes.back().find("cannot follow its shape") != std::string::npos);
}

TEST_CASE("meshing from the winding number can be cancelled") {
    class Stop : public Progress {
    public:
        [[nodiscard]] bool cancelled() const override { return ++asked_ > 1000; }

    private:
        mutable int asked_ = 0;
    } stop;
    TriMesh hole = cube();
    hole.triangles.pop_back();
    const Result<TetMesh> mesh = mesh_by_winding(hole, 0.4, 30, stop);
    REQUIRE_FALSE(mesh);
    CHECK(mesh.error().cause == Cause::cancelled);
}
