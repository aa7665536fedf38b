#include "geometry/mesher/mesher.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <random>

#include "base/core/near.hpp"
#include "geometry/mesh/curved_tets.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "geometry/repair/surface_check.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;

namespace {

/// A bar of 100 x 20 x 15 with `gaps` V notches of 1 to 10 mm width and 10 mm depth.
Solid notched_bar(int gaps) {
    const Solid notch = solid(PrismSolid{{{13.5, 5}, {14.5, 5}, {19, 15}, {9, 15}}, {0, 2, 1}, 0, 20});
    return without(box({0, 0, 0}, {100, 20, 15}), solid(RepeatedSolid{notch, gaps, {14, 0, 0}}));
}

TetMesh mesh_of(const std::vector<BodyGeometry>& bodies, double size, int order = 1) {
    Progress silent;
    Result<TetMesh> mesh = mesh_bodies(bodies, {.size = size, .order = order}, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    return *mesh;
}

/// With the curved faces of quadratic tets.
double round_volume(const TetMesh& mesh, int region = 0) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) sum += mesh.region[t] == region ? curved_volume(mesh, t) : 0;
    return sum;
}

std::string problem(const std::vector<BodyGeometry>& bodies, double size) {
    Progress silent;
    const Result<TetMesh> mesh = mesh_bodies(bodies, {.size = size, .order = 1}, silent);
    return mesh ? "" : mesh.error().message;
}

}  // namespace

TEST_CASE("a notched bar keeps its volume and its sharp edges, for any number of notches") {
    for (const int gaps : {1, 3, 6}) {
        const TetMesh mesh = mesh_of({{"bar", notched_bar(gaps)}}, 5);
        CHECK(volume(mesh) == near(100 * 20 * 15 - gaps * 20 * 10 * 5.5, {.relative = 1e-9}));
        const MeshReport report = report_on(mesh);
        CHECK(report.worst_quality > 0.05);
        CHECK(report.median_quality > 0.25);
        CHECK(report.box.size().x == near(100, {.relative = 1e-12}));
    }
}

TEST_CASE("bodies that touch share the nodes of their common face") {
    const TetMesh mesh =
        mesh_of({{"left", box({0, 0, 0}, {10, 10, 10})}, {"right", box({10, 0, 0}, {20, 10, 10})}}, 4, 2);
    CHECK(mesh.region_names == std::vector<std::string>{"left", "right"});
    CHECK(volume(mesh, 0) == near(1000, {.relative = 1e-9}));
    CHECK(volume(mesh, 1) == near(1000, {.relative = 1e-9}));
    TriMesh outer{mesh.points, {}};
    double area = 0;
    for (const Face& face : boundary_faces(mesh)) {
        outer.triangles.push_back({face.nodes[0], face.nodes[1], face.nodes[2]});
        const auto& p = mesh.points;
        area += 0.5 * norm(cross(p[face.nodes[1]] - p[face.nodes[0]], p[face.nodes[2]] - p[face.nodes[0]]));
    }
    CHECK(check_closed(outer));
    CHECK(area == near(2 * 100 + 4 * 200, {.relative = 1e-12}));  // the common face is not part of the outside
}

TEST_CASE("round bodies converge to their volume, faster with curved quadratic tets") {
    const Solid ball = solid(SphereSolid{{1, 2, 3}, 5});
    const double exact = 4.0 / 3 * std::numbers::pi * 125;
    CHECK(*solid_volume(ball) == near(exact, {.relative = 1e-12}));
    const double coarse = exact - volume(mesh_of({{"ball", ball}}, 3));
    const double fine = exact - volume(mesh_of({{"ball", ball}}, 1));
    CHECK(coarse > 0);
    CHECK(fine < coarse / 3);
    const TetMesh curved = mesh_of({{"ball", ball}}, 3, 2);
    double farthest = 0;
    for (const Face& face : boundary_faces(curved)) {
        for (const int node : face.nodes)
            farthest = std::max(farthest, std::fabs(norm(curved.points[node] - Vec3{1, 2, 3}) - 5));
    }
    CHECK(farthest < 1e-6);  // mid-edge nodes lie on the sphere too
}

TEST_CASE("rotated, translated and united solids agree with membership") {
    const Solid arm = solid(RotatedSolid{box({0, -1, -1}, {10, 1, 1}), {0, 0, 0}, {0, 0, 1}, std::numbers::pi / 2});
    const Solid cross = solid(CombinedSolid{CombinedSolid::Operation::unite, {box({0, -1, -1}, {10, 1, 1}), arm}});
    CHECK(*solid_volume(cross) == near(40 + 40 - 2, {.relative = 1e-12}));
    const TetMesh mesh = mesh_of({{"cross", cross}}, 2);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        Vec3 centroid;
        for (const int node : mesh.tet(t)) centroid += 0.25 * mesh.points[node];
        CHECK(contains(cross, centroid));
    }
}

TEST_CASE("round shapes that Open CASCADE gets wrong at first have the volume of their drawing") {
    using Operation = CombinedSolid::Operation;
    const Solid disc = solid(CylinderSolid{{0, 0, 0}, {0, 0, 4}, 10});
    const Solid rod = solid(CylinderSolid{{2, -1, -3}, {2, -1, 1}, 3});
    const Solid ball = solid(SphereSolid{{4, -2, -3}, 2});
    const Solid wide = solid(CylinderSolid{{0, 0, 0}, {0, 0, 2}, 4});
    const Solid beside = solid(SphereSolid{{-5, 1, 2}, 4});
    struct Case {
        const char* name;
        Solid solid;
        double volume;
    };
    // Volumes by integration in the plane.
    for (const Case& one :
         {Case{"a seam in the rim", without(disc, solid(SphereSolid{{0, 10, 2}, 2})), 1240.51},
          Case{"a ball opposite, which crashed", without(disc, solid(SphereSolid{{0, -10, 2}, 2})), 1240.51},
          Case{"a bite out of a rod", without(rod, ball), 101.11},
          Case{"the bite itself", solid(CombinedSolid{Operation::intersect, {rod, ball}}), 11.98},
          Case{"a rod with a ball", solid(CombinedSolid{Operation::unite, {rod, ball}}), 134.62},
          Case{"a crash", without(wide, beside), 78.03},
          Case{"another crash", solid(CombinedSolid{Operation::unite, {wide, beside}}), 346.11}}) {
        CAPTURE(one.name);
        const Result<double> exact = solid_volume(one.solid);
        REQUIRE_MESSAGE(exact, (exact ? "" : exact.error().message));
        CHECK(*exact == near(one.volume, {.relative = 1e-3}));
        const Result<TriMesh> surface = tessellate(one.solid, 0.01);
        REQUIRE_MESSAGE(surface, (surface ? "" : surface.error().message));
        CHECK(signed_volume(*surface) == near(one.volume, {.relative = 6e-3}));
        CHECK(round_volume(mesh_of({{"b", one.solid}}, 3, 2)) == near(one.volume, {.relative = 0.05}));
    }
}

TEST_CASE("round bodies of which Open CASCADE overlooks the overlap share it all the same") {
    const TetMesh mesh = mesh_of(
        {{"rod", solid(CylinderSolid{{2, -1, -3}, {2, -1, 1}, 3})}, {"ball", solid(SphereSolid{{4, -2, -3}, 2})}}, 1.5,
        2);
    CHECK(round_volume(mesh, 0) == near(101.11, {.relative = 0.02}));
    CHECK(round_volume(mesh, 1) == near(4.0 / 3 * std::numbers::pi * 8, {.relative = 0.01}));
    REQUIRE(mesh.notes.size() == 1);
    CHECK(mesh.notes.front().find("overlap in a volume of 11.98") != std::string::npos);
}

TEST_CASE("shapes that touch in a point or along a line are one body with the sum of their volumes") {
    using Operation = CombinedSolid::Operation;
    const double ball = 4.0 / 3 * std::numbers::pi * 8;
    const double rod = std::numbers::pi * 4 * 4;
    const Solid sphere = solid(SphereSolid{{0, 0, 0}, 2});
    struct Case {
        Solid solid;
        double volume;
    };
    for (const Case& one :
         {Case{solid(CombinedSolid{Operation::unite, {sphere, box({2, -2, -2}, {4, 2, 2})}}), ball + 32},
          Case{solid(RepeatedSolid{sphere, 3, {4, 0, 0}}), 3 * ball},
          Case{solid(CombinedSolid{
                   Operation::unite,
                   {solid(CylinderSolid{{0, 0, 0}, {0, 0, 4}, 2}), solid(CylinderSolid{{4, 0, 0}, {4, 0, 4}, 2})}}),
               2 * rod}}) {
        const Result<double> exact = solid_volume(one.solid);
        REQUIRE_MESSAGE(exact, (exact ? "" : exact.error().message));
        CHECK(*exact == near(one.volume, {.relative = 1e-6}));
        CHECK(round_volume(mesh_of({{"b", one.solid}}, 1.5, 2)) == near(one.volume, {.relative = 0.02}));
    }
}

TEST_CASE("repeated copies are united whether they overlap, touch or stand apart") {
    for (const auto& [step, exact] : {std::pair(0.5, 3.5), std::pair(1.0, 6.0), std::pair(1.5, 6.0)}) {
        const Solid row = solid(RepeatedSolid{box({0, 0, 0}, {1, 1, 1}), 6, {step, 0, 0}});
        CHECK(*solid_volume(row) == near(exact, {.relative = 1e-12}));
        const Solid rest = without(box({-1, -1, -1}, {11, 2, 2}), row);
        CHECK(*solid_volume(rest) == near(108 - exact, {.relative = 1e-12}));
    }
    const Solid row = solid(RepeatedSolid{box({0, 0, 0}, {1, 1, 1}), 3, {1, 0, 0}});
    CHECK(volume(mesh_of({{"row", row}}, 1)) == near(3, {.relative = 1e-12}));
}

TEST_CASE("surfaces for the slicer are closed and exact where they are flat") {
    const Result<TriMesh> bar = tessellate(notched_bar(6), 0.01);
    REQUIRE_MESSAGE(bar, (bar ? "" : bar.error().message));
    CHECK(check_closed(*bar));
    CHECK(signed_volume(*bar) == near(30000 - 6 * 1100, {.relative = 1e-9}));
    const Result<TriMesh> ball = tessellate(solid(SphereSolid{{0, 0, 0}, 5}), 0.01);
    REQUIRE(ball);
    CHECK(check_closed(*ball));
    CHECK(signed_volume(*ball) == near(4.0 / 3 * std::numbers::pi * 125, {.relative = 5e-3}));
}

TEST_CASE("a long thin rod, alone and on a plate, gets no more triangles than its roundness needs") {
    const double rod_volume = std::numbers::pi * 4 * 240;
    const Solid rod = solid(CylinderSolid{{0, 0, 0}, {0, 0, 240}, 2});
    const Solid plate = solid(CylinderSolid{{0, 0, -5}, {0, 0, 0}, 25});
    const Solid both = solid(CombinedSolid{CombinedSolid::Operation::unite, {rod, plate}});
    for (const auto& [body, exact] :
         {std::pair(rod, rod_volume), std::pair(both, rod_volume + std::numbers::pi * 625 * 5)}) {
        const Result<TriMesh> surface = tessellate(body, 0.01);
        REQUIRE_MESSAGE(surface, (surface ? "" : surface.error().message));
        CHECK(check_closed(*surface));
        CHECK(surface->triangles.size() < 300000);
        CHECK(signed_volume(*surface) == near(exact, {.relative = 5e-3}));
    }
}

TEST_CASE("cavities look inwards, and every chord of a curve keeps to the tolerance") {
    const double pi = std::numbers::pi;
    const Solid ball = solid(SphereSolid{{0, 0, 0}, 5});
    const Solid rod = solid(CylinderSolid{{0, 0, -9}, {0, 0, 9}, 2});
    const Solid cube = box({-10, -10, -10}, {10, 10, 10});
    for (const auto& [cavity, gone] : {std::pair(ball, 4.0 / 3 * pi * 125), std::pair(rod, pi * 4 * 18)}) {
        const Result<TriMesh> hollow = tessellate(without(cube, cavity), 0.01);
        REQUIRE_MESSAGE(hollow, (hollow ? "" : hollow.error().message));
        CHECK(check_closed(*hollow));
        CHECK(signed_volume(*hollow) == near(8000 - gone, {.relative = 1e-3}));
        CHECK(signed_volume(*tessellate(cavity, 0.01)) == near(gone, {.relative = 1e-2}));
    }
    double farthest = 0;
    const TriMesh surface = *tessellate(ball, 0.01);
    for (const auto& [a, b, c] : surface.triangles)
        farthest = std::max(farthest, 5 - norm(surface.points[a] + surface.points[b] + surface.points[c]) / 3);
    CHECK(farthest > 0);
    CHECK(farthest < 0.01);
}

TEST_CASE("small balls in a large body get what their own radius needs, and no more") {
    const auto pitted = [](double side) {
        return without(box({0, 0, 0}, {side, side, side}), solid(SphereSolid{{side / 2, side / 2, side}, 1.5}));
    };
    const Result<TriMesh> small = tessellate(pitted(4), 0.01), large = tessellate(pitted(400), 0.01);
    REQUIRE(small);
    REQUIRE(large);
    CHECK(check_closed(*large));
    CHECK(large->triangles.size() < 1.5 * static_cast<double>(small->triangles.size()));
    double farthest = 0;
    for (const auto& [a, b, c] : large->triangles) {
        const Vec3 &p = large->points[a], &q = large->points[b], &r = large->points[c];
        const Vec3 middle{200, 200, 400};
        if (norm(p - middle) > 1.6 || norm(q - middle) > 1.6 || norm(r - middle) > 1.6) continue;
        if (p.z > 399.999 && q.z > 399.999 && r.z > 399.999) continue;
        farthest = std::max(farthest, 1.5 - norm((1.0 / 3) * (p + q + r) - middle));
    }
    CHECK(farthest > 0);
    CHECK(farthest < 0.01);
}

TEST_CASE("a face that is less curved than its body is large is no flat face, beside balls and alone") {
    // A slab of 40 mm whose top is part of a cylinder of radius 60 mm.
    const Solid rod = solid(CylinderSolid{{0, -30, 0}, {0, 30, 0}, 60});
    const Solid block = box({-20, -20, 40}, {20, 20, 62});
    const Solid slab = solid(CombinedSolid{CombinedSolid::Operation::intersect, {block, rod}});
    const Solid pitted = without(slab, solid(SphereSolid{{0, 0, 40}, 1.5}));
    for (const Solid& body : {slab, pitted}) {
        const Result<TriMesh> surface = tessellate(body, 0.01);
        REQUIRE_MESSAGE(surface, (surface ? "" : surface.error().message));
        double farthest = 0;
        for (const auto& [a, b, c] : surface->triangles) {
            const Vec3 middle = (1.0 / 3) * (surface->points[a] + surface->points[b] + surface->points[c]);
            const double radius = std::hypot(middle.x, middle.z);
            const bool top = radius > 59 && std::fabs(middle.x) < 19.9 && std::fabs(middle.y) < 19.9;
            if (top) farthest = std::max(farthest, 60 - radius);
        }
        CHECK(farthest > 0);
        CHECK(farthest < 0.03);
    }
}

TEST_CASE("the long edge of a rod that is cut obliquely keeps to the tolerance") {
    const Solid rod = solid(CylinderSolid{{0, 0, -40}, {0, 0, 40}, 2});
    const Solid half = solid(RotatedSolid{box({-100, -100, -100}, {100, 100, 0}), {0, 0, 0}, {0, 1, 0}, 1.35});
    const Result<TriMesh> cut =
        tessellate(solid(CombinedSolid{CombinedSolid::Operation::intersect, {rod, half}}), 0.01);
    REQUIRE_MESSAGE(cut, (cut ? "" : cut.error().message));
    CHECK(check_closed(*cut));
    const auto radius = [](const Vec3& p) { return std::hypot(p.x, p.y); };
    // Inclined by 1.35 about y: the plane of the cut contains the direction (sin, 0, cos) of its long axis.
    const auto on_cut = [](const Vec3& p) { return std::fabs(std::sin(1.35) * p.x + std::cos(1.35) * p.z) < 1e-6; };
    double farthest = 0;
    int edges = 0;
    for (const auto& triangle : cut->triangles)
        for (int k = 0; k < 3; ++k) {
            const Vec3 &p = cut->points[triangle[k]], &q = cut->points[triangle[(k + 1) % 3]];
            const bool rim = on_cut(p) && on_cut(q) && radius(p) > 1.999 && radius(q) > 1.999;
            if (!rim || p.y * q.y < 0) continue;
            ++edges;
            farthest = std::max(farthest, 2 - radius(0.5 * (p + q)));
        }
    CHECK(edges > 20);
    CHECK(farthest < 0.01);
}

TEST_CASE("a thin curved wall is meshed finer than its element size asks for") {
    const Solid tube =
        without(solid(CylinderSolid{{0, 0, 0}, {0, 0, 10}, 5}), solid(CylinderSolid{{0, 0, -1}, {0, 0, 11}, 4.8}));
    const double exact = std::numbers::pi * (25 - 4.8 * 4.8) * 10;
    CHECK(volume(mesh_of({{"tube", tube}}, 8, 2)) == near(exact, {.relative = 0.05}));
}

TEST_CASE("a thin curved wall of quadratic tets has the volume of its drawing, or a note says by how much it is off") {
    for (const double inner : {4.8, 4.5, 4.0}) {
        for (const double size : {2.0, 3.0}) {
            CAPTURE(inner);
            CAPTURE(size);
            const Solid tube = without(solid(CylinderSolid{{0, 0, 0}, {0, 0, 20}, 5}),
                                       solid(CylinderSolid{{0, 0, -1}, {0, 0, 21}, inner}));
            const TetMesh mesh = mesh_of({{"tube", tube}}, size, 2);
            const double exact = 20 * std::numbers::pi * (25 - inner * inner),
                         found = report_on(mesh).regions[0].volume;
            MESSAGE(mesh.tet_count(), " tets, volume ", found, " of ", exact);
            const bool noted = std::ranges::any_of(
                mesh.notes, [](const std::string& note) { return note.find("thin and curved") != std::string::npos; });
            CHECK((noted || std::fabs(found / exact - 1) < 0.03));
            CHECK(std::fabs(found / exact - 1) < 0.06);
        }
    }
}

TEST_CASE("a surface body is meshed anew to the wanted size") {
    const Result<TriMesh> surface = tessellate(notched_bar(3), 0.01);
    REQUIRE(surface);
    const TetMesh mesh = mesh_of({{"bar", *surface}}, 4);
    CHECK(volume(mesh) == near(30000 - 3 * 1100, {.relative = 1e-12}));
    CHECK(mesh.tet_count() > 1000);
    CHECK(report_on(mesh).worst_quality > 0.02);
}

TEST_CASE("the mesh size is checked against the material's volume, not against the bounding box") {
    const Solid rod = box({0, 0, 0}, {500, 2, 2});
    const Solid turned = solid(RotatedSolid{rod, {0, 0, 0}, {0, 0, 1}, 0.7});
    const Solid tilted = solid(RotatedSolid{turned, {0, 0, 0}, {0, 1, 0}, 0.7});
    CHECK(volume(mesh_of({{"rod", tilted}}, 2)) == near(2000, {.relative = 1e-9}));
    // A thin sheet has little volume and many triangles.
    CHECK(problem({{"sheet", box({0, 0, 0}, {500, 500, 1e-4})}}, 0.1).find("tetrahedra, more than") !=
          std::string::npos);
    Progress silent;
    CHECK_FALSE(mesh_bodies({}, {.size = 1}, silent));
    CHECK_FALSE(tessellate(box({0, 0, 0}, {1, 1, 1}), 0));
}

TEST_CASE("bodies too small or too large for the mesher are refused, those within the limits are meshed") {
    Progress silent;
    for (const double edge : {1e-8, 1e-5, 1e5, 1e6}) {
        const std::vector<BodyGeometry> bodies{{"cube", box({0, 0, 0}, {edge, edge, edge})}};
        const Result<TetMesh> mesh = mesh_bodies(bodies, {.size = edge / 2, .order = 1}, silent);
        const bool possible = edge > 1e-7 && edge < 1e6;
        REQUIRE_MESSAGE(mesh.has_value() == possible, (mesh ? "" : mesh.error().message));
        if (mesh)
            CHECK(volume(*mesh) == near(edge * edge * edge, {.relative = 1e-6}));
        else
            CHECK(mesh.error().message.find("choose another length_unit") != std::string::npos);
    }
}

TEST_CASE("a surface so far from the origin that its shape has no digits left is refused") {
    Progress silent;
    const TriMesh cube = tessellate(box({0, 0, 0}, {10, 10, 10}), 0.1).value();
    const auto moved = [&](double by) {
        TriMesh surface = cube;
        for (Vec3& p : surface.points) p.x += by;
        return mesh_bodies(std::vector<BodyGeometry>{{"cube", surface}}, {.size = 5, .order = 1}, silent);
    };
    CHECK(moved(1e5));
    const auto far = moved(1e8);
    REQUIRE_FALSE(far);
    CHECK(far.error().message.starts_with("body \"cube\" measures 17.3 and lies 1e+08 from the origin"));
}

TEST_CASE("a remeshed sphere tells how much of its volume is lost, a cube has nothing to tell") {
    Progress silent;
    const auto notes_of = [&](const Solid& drawn) {
        const TriMesh surface = tessellate(drawn, 0.01).value();
        const auto mesh = mesh_bodies(std::vector<BodyGeometry>{{"b", surface}}, {.size = 4, .order = 1}, silent);
        REQUIRE(mesh);
        std::string notes;
        for (const std::string& note : mesh->notes) notes += note + "\n";
        return notes;
    };
    CHECK(notes_of(solid(SphereSolid{{0, 0, 0}, 10})).find("% less than its file") != std::string::npos);
    CHECK(notes_of(box({0, 0, 0}, {10, 10, 10})).find("than its file") == std::string::npos);
}

TEST_CASE("the wall of a hollow surface is meshed, however thin, and not its cavity") {
    Progress silent;
    TriMesh hollow = tessellate(solid(SphereSolid{{0, 0, 0}, 10}), 0.1).value();
    TriMesh cavity = scaled(hollow, 0.98);
    for (auto& triangle : cavity.triangles) std::swap(triangle[0], triangle[1]);
    append(hollow, cavity);
    const auto mesh = mesh_bodies(std::vector<BodyGeometry>{{"b", hollow}}, {.size = 6, .order = 1}, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(volume(*mesh) == near(signed_volume(hollow), {.relative = 0.1}));
}

TEST_CASE("triangles that have nothing to do with each other enclose nothing") {
    Progress silent;
    TriMesh soup;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> anywhere(-10, 10);
    for (int t = 0; t < 100; ++t) {
        for (int k = 0; k < 3; ++k) soup.points.push_back({anywhere(random), anywhere(random), anywhere(random)});
        soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const auto mesh = mesh_bodies(std::vector<BodyGeometry>{{"soup", soup}}, {.size = 2, .order = 1}, silent);
    REQUIRE_FALSE(mesh);
    CHECK(mesh.error().message.find("encloses nothing") != std::string::npos);
}

TEST_CASE("a caller that cancels gets no mesh") {
    struct Cancelled : Progress {
        [[nodiscard]] bool cancelled() const override { return true; }
    } stop;
    const std::vector<BodyGeometry> bodies = {{"a", *tessellate(box({0, 0, 0}, {1, 1, 1}), 0.1)}};
    const Result<TetMesh> mesh = mesh_bodies(bodies, {.size = 1}, stop);
    REQUIRE_FALSE(mesh);
    CHECK(mesh.error().cause == Cause::cancelled);
}

TEST_CASE("a surface body may have several shells and cavities") {
    const Solid hollow = without(box({0, 0, 0}, {10, 10, 10}), box({3, 3, 3}, {7, 7, 7}));
    const Solid both = solid(CombinedSolid{CombinedSolid::Operation::unite, {hollow, box({20, 0, 0}, {30, 10, 10})}});
    const Result<TriMesh> surface = tessellate(both, 0.1);
    REQUIRE(surface);
    const TetMesh mesh = mesh_of({{"a", *surface}}, 3, 2);
    CHECK(mesh.order == 2);
    CHECK(volume(mesh) == near(1000 - 64 + 1000, {.relative = 1e-12}));
}

TEST_CASE("a small hole keeps its round quadratic faces") {
    const Solid hole = solid(CylinderSolid{{20, 10, -1}, {20, 10, 11}, 1.5});
    const TetMesh mesh = mesh_of({{"plate", without(box({0, 0, 0}, {40, 20, 10}), hole)}}, 5, 2);
    std::size_t on_wall = 0;
    double farthest = 0;
    for (const Face& face : boundary_faces(mesh)) {
        const auto radius = [&](int node) { return std::hypot(mesh.points[node].x - 20, mesh.points[node].y - 10); };
        if (radius(face.nodes[0]) > 1.6 || radius(face.nodes[1]) > 1.6 || radius(face.nodes[2]) > 1.6) continue;
        ++on_wall;
        for (const int node : face.nodes) farthest = std::max(farthest, std::fabs(radius(node) - 1.5));
    }
    CHECK(on_wall >= 8);
    CHECK(farthest < 1e-6);
}

TEST_CASE("the same bodies give the same mesh, byte for byte") {
    const std::vector<BodyGeometry> bodies = {{"a", notched_bar(2)}, {"b", box({100, 0, 0}, {110, 20, 15})}};
    const TetMesh first = mesh_of(bodies, 5, 2);
    const TetMesh second = mesh_of(bodies, 5, 2);
    REQUIRE(first.points.size() == second.points.size());
    CHECK(std::memcmp(first.points.data(), second.points.data(), first.points.size() * sizeof(Vec3)) == 0);
    CHECK(first.nodes == second.nodes);
}

TEST_CASE("where bodies overlap the later one keeps the volume, and a note says how much") {
    const Solid left = box({0, 0, 0}, {10, 10, 10});
    const Solid right = box({8, 0, 0}, {20, 10, 10});
    const TetMesh mesh = mesh_of({{"left", left}, {"right", right}}, 4, 1);
    CHECK(volume(mesh, 0) == near(800, {.relative = 1e-12}));
    CHECK(volume(mesh, 1) == near(1200, {.relative = 1e-12}));
    REQUIRE(mesh.notes.size() == 1);
    CHECK(mesh.notes[0].find("\"left\" and \"right\" overlap in a volume of 200 ") == 0);
    CHECK(mesh.notes[0].find("belongs to \"right\"") != std::string::npos);
    const TetMesh other = mesh_of({{"right", right}, {"left", left}}, 4, 1);
    CHECK(volume(other, 0) == near(1000, {.relative = 1e-12}));
}

TEST_CASE("enclosed space is a region of its own; an open mouth is closed with a cap") {
    const auto enclosed = [](const Vec3& at, std::vector<Solid> walls) {
        return std::make_shared<const SolidNode>(SolidNode{EnclosedSolid{at, std::move(walls)}});
    };
    const Solid shell = without(box({0, 0, 0}, {10, 10, 10}), box({3, 3, 3}, {7, 7, 7}));
    const TetMesh closed = mesh_of({{"shell", shell}, {"air", enclosed({5, 5, 5}, {shell})}}, 4, 1);
    CHECK(volume(closed, 1) == near(64, {.relative = 1e-12}));
    CHECK(boundary_faces(closed).size() < region_faces(closed, 0).size());  // the air fills the cavity
    const Solid pot = without(box({0, 0, 0}, {10, 10, 10}), box({3, 3, 3}, {7, 7, 11}));
    const std::string open = problem({{"pot", pot}, {"air", enclosed({5, 5, 5}, {pot})}}, 4);
    CHECK(open.find("chamber \"air\": the point (5, 5, 5) lies in no closed cavity") != std::string::npos);
    const Solid lid = box({2, 2, 10}, {8, 8, 11});
    const TetMesh capped = mesh_of({{"pot", pot}, {"air", enclosed({5, 5, 5}, {pot, lid})}}, 4, 1);
    CHECK(volume(capped, 0) == near(1000 - 7 * 16, {.relative = 1e-12}));
    CHECK(volume(capped, 1) == near(7 * 16, {.relative = 1e-12}));
}

TEST_CASE("a narrow gap between bodies is closed with a note, a wider one is kept") {
    const std::vector<BodyGeometry> bars = {{"left", box({0, 0, 0}, {10, 10, 10})},
                                            {"right", box({10.004, 2, 2}, {20, 8, 8})}};
    const Solid hole = solid(CylinderSolid{{5, 5, 0}, {5, 5, 4}, 2});
    const std::vector<BodyGeometry> pin = {{"block", without(box({0, 0, 0}, {10, 10, 4}), hole)},
                                           {"pin", solid(CylinderSolid{{5, 5, 0}, {5, 5, 4}, 1.996})}};
    const auto mesh_with = [](const std::vector<BodyGeometry>& bodies, double close_gaps) {
        Progress silent;
        Result<TetMesh> mesh = mesh_bodies(bodies, {.size = 2, .order = 1, .close_gaps = close_gaps}, silent);
        REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
        return *mesh;
    };
    struct Row {
        const std::vector<BodyGeometry>* bodies;
        double whole, between;  ///< surface areas: of both bodies, and of the face between them
    };
    const double pi = std::numbers::pi;
    for (const Row& row :
         {Row{&bars, 6 * 100 + 2 * 36 + 4 * 60, 36}, Row{&pin, 2 * 100 + 4 * 40 + 2 * 16 * pi, 16 * pi}}) {
        const auto area = [](const TetMesh& mesh) {
            double sum = 0;
            for (const Face& f : boundary_faces(mesh)) {
                const Vec3& p = mesh.points[f.nodes[0]];
                sum += norm(cross(mesh.points[f.nodes[1]] - p, mesh.points[f.nodes[2]] - p)) / 2;
            }
            return sum;
        };
        const TetMesh open = mesh_with(*row.bodies, 0.003);
        CHECK(open.notes.empty());
        CHECK(area(open) == near(row.whole, {.relative = 0.02}));
        const TetMesh closed = mesh_with(*row.bodies, 0.01);
        CHECK(area(closed) == near(row.whole - 2 * row.between, {.relative = 0.02}));
        CHECK(volume(closed) == near(volume(open), {.relative = 0.01}));
        REQUIRE(closed.notes.size() == 1);
        CAPTURE(closed.notes.front());
        CHECK(closed.notes.front().find("between \"" + row.bodies->front().name) != std::string::npos);
        if (row.bodies == &bars) CHECK(closed.notes.front().starts_with("a gap of 0.004 between"));
        CHECK(closed.notes.front().find("was closed") != std::string::npos);
    }
}

TEST_CASE("invalid bodies are refused with a reason") {
    CHECK(problem({{"a", box({1, 1, 1}, {2, 2, 2})}, {"b", box({0, 0, 0}, {5, 5, 5})}}, 3)
              .find("body \"a\" is empty: all of it belongs to later ones") != std::string::npos);
    CHECK(problem({{"a", without(box({0, 0, 0}, {1, 1, 1}), box({-1, -1, -1}, {2, 2, 2}))}}, 1).find("is empty") !=
          std::string::npos);
    CHECK(problem({{"a", box({0, 0, 0}, {100, 100, 100})}}, 0.1).find("tetrahedra, more than") != std::string::npos);
    TriMesh open = *tessellate(box({0, 0, 0}, {1, 1, 1}), 0.1);
    open.triangles.resize(2);
    const std::string sheet = problem({{"a", open}}, 1);
    CHECK(sheet.find("body \"a\": the surface encloses nothing: it is an open sheet") == 0);
    CHECK(sheet.find("not closed: ") != std::string::npos);
    Progress silent;
    CHECK_FALSE(mesh_bodies({}, {.size = 1}, silent));
    CHECK_FALSE(tessellate(box({0, 0, 0}, {1, 1, 1}), 0));
}

TEST_CASE("meshes of drawn solids have no slivers") {
    // As meshed by Gmsh these have angles of 0.3 to 3 degrees.
    struct Box {
        Vec3 sides;
        double size;
    };
    for (const auto& [sides, size] :
         {Box{{20, 5, 2}, 3}, Box{{20, 10, 4}, 3}, Box{{20, 20, 2}, 2.3}, Box{{37, 5, 2}, 1.7}, Box{{37, 5, 2}, 3},
          Box{{37, 5, 4}, 3}, Box{{37, 5, 7}, 4}, Box{{37, 5, 12}, 4}}) {
        const TetMesh mesh = mesh_of({{"box", box({0, 0, 0}, sides)}}, size, 2);
        CHECK(volume(mesh) == near(sides.x * sides.y * sides.z, {.relative = 1e-9}));
        const double angle = smallest_dihedral_deg(mesh);
        CHECK_MESSAGE(angle >= 5, angle << " degrees: " << sides.x << " x " << sides.y << " x " << sides.z);
    }
}
