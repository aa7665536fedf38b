#include "printing/slice/repair.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "base/core/near.hpp"
#include "printing/slice/holes.hpp"
#include "printing/slice/shells.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;
using mesh::TriMesh;

namespace {

double volume_um3(const GridSurface& surface) {
    return volume_mm3(surface) * 1e9;
}

bool is_closed(const GridSurface& surface) {
    GridSurface copy = surface;
    (void)close_holes(copy);
    return copy.triangles.size() == surface.triangles.size();
}

const TriMesh cube = box({0, 0, 0}, {1000, 1000, 1000});

Repaired repaired(const TriMesh& mesh) {
    auto result = repair(mesh, "body 'b' (soft)", 50);
    REQUIRE_MESSAGE(result.has_value(), (result ? "" : result.error().message));
    CHECK(is_closed(result->surface));
    return std::move(*result);
}

std::string refused_mesh(const TriMesh& mesh) {
    const auto result = repair(mesh, "body 'b' (soft)", 50);
    REQUIRE(!result.has_value());
    CHECK(result.error().cause == Cause::input);
    return result.error().message;
}

}  // namespace

TEST_CASE("a good cube is welded and otherwise not changed") {
    const Repaired r = repaired(cube);
    CHECK(r.surface.points.size() == 8);
    CHECK(r.surface.triangles.size() == 12);
    CHECK(volume_um3(r.surface) == near(1e9, {.relative = 1e-12}));
    CHECK(r.warnings.empty());
}

TEST_CASE("a hole in the top is in the uppermost layer, not in one that the part does not have") {
    TriMesh open = cube;
    const auto in_top = [&](const auto& triangle) {
        return std::all_of(triangle.begin(), triangle.end(), [&](int p) { return cube.points[p].z == 1000; });
    };
    open.triangles.erase(std::find_if(open.triangles.begin(), open.triangles.end(), in_top));
    const auto warning = [&](const Layers& layers) {
        const auto repaired = repair(open, "b", layers);
        REQUIRE_MESSAGE(repaired, (repaired ? "" : repaired.error().message));
        REQUIRE(repaired->warnings.size() == 1);
        return repaired->warnings.front();
    };
    CHECK(warning(50).ends_with("closed in layer 20"));   // 20 layers
    CHECK(warning(300).ends_with("closed in layer 3"));   // 900 um: the middle of a fourth would be at 1050
    CHECK(warning(2500).ends_with("closed in layer 1"));  // thinner than half a layer
}

TEST_CASE("any missing triangle is filled in, with a warning that names body and layers") {
    for (std::size_t i = 0; i < cube.triangles.size(); ++i) {
        TriMesh open = cube;
        open.triangles.erase(open.triangles.begin() + static_cast<long>(i));
        const Repaired r = repaired(open);
        CHECK(volume_um3(r.surface) == near(1e9, {.relative = 1e-12}));
        REQUIRE(r.warnings.size() == 1);
        CHECK(r.warnings[0].find("body 'b' (soft): 1 hole (3 open edges") == 0);
    }
    TriMesh no_side = cube;
    no_side.triangles.resize(10);  // the last side, both triangles: a square hole from z = 0 to 1000
    const Repaired r = repaired(no_side);
    CHECK(volume_um3(r.surface) == near(1e9, {.relative = 1e-9}));
    CHECK(r.warnings[0] == "body 'b' (soft): 1 hole (4 open edges, 1 mm^2) closed in layers 1 to 20");
}

TEST_CASE("a T-junction is closed without a warning") {
    TriMesh mesh = cube;
    // One triangle of the last side is split at the middle of its diagonal; its neighbour is not.
    const auto [a, b, c] = mesh.triangles.back();
    const Vec3 pa = mesh.points[a], pb = mesh.points[b], pc = mesh.points[c];
    mesh.triangles.pop_back();
    add_triangle(mesh, pa, (pa + pb) * 0.5, pc);
    add_triangle(mesh, (pa + pb) * 0.5, pb, pc);
    const Repaired r = repaired(mesh);
    CHECK(r.warnings.empty());
    CHECK(volume_um3(r.surface) == near(1e9, {.relative = 1e-12}));
}

TEST_CASE("points at open edges closer than a pixel are joined, with a note, and thin walls stay") {
    TriMesh torn = box({0, 0, 0}, {1000, 1000, 20});
    for (std::size_t i = 0; i < torn.points.size(); i += 3) torn.points[i] += Vec3{3, -2, 1};
    const auto apart = repair(torn, "body 'b' (soft)", 50);
    CHECK((!apart || !apart->warnings.empty()));
    const auto result = repair(torn, "body 'b' (soft)", 50, 5);
    REQUIRE_MESSAGE(result.has_value(), (result ? "" : result.error().message));
    CHECK(is_closed(result->surface));
    CHECK(result->surface.points.size() == 8);
    CHECK(volume_um3(result->surface) == near(2e7, {.relative = 1e-12}));
    REQUIRE(result->warnings.size() == 1);
    CHECK(result->warnings[0].find(" at open edges to another one within 5 um") != std::string::npos);
    // Closed surfaces are not changed, however thin.
    const auto thin = repair(box({0, 0, 0}, {1000, 1000, 2}), "body 'b' (soft)", 50, 5);
    REQUIRE(thin);
    CHECK(volume_um3(thin->surface) == near(2e6, {.relative = 1e-12}));
    CHECK(thin->warnings.empty());
}

TEST_CASE("inverted surfaces are turned over: all, one triangle, one of two shells") {
    const Repaired whole = repaired(turned_inside_out(cube));
    CHECK(volume_um3(whole.surface) == near(1e9, {.relative = 1e-12}));
    CHECK(whole.warnings == std::vector<std::string>{"body 'b' (soft): flipped 1 shell that was inside out"});

    TriMesh one = cube;
    std::swap(one.triangles[3][0], one.triangles[3][1]);
    const Repaired triangle = repaired(one);
    CHECK(volume_um3(triangle.surface) == near(1e9, {.relative = 1e-12}));
    CHECK(triangle.warnings.size() == 1);

    const TriMesh small = box({2000, 0, 0}, {2500, 500, 500});
    const Repaired two = repaired(together(cube, turned_inside_out(small)));
    CHECK(volume_um3(two.surface) == near(1.125e9, {.relative = 1e-12}));
    CHECK(two.warnings.size() == 1);
}

TEST_CASE("a cavity stays a cavity, also in an inverted solid") {
    const TriMesh hollow = together(cube, turned_inside_out(box({200, 200, 200}, {800, 800, 800})));
    CHECK(volume_um3(repaired(hollow).surface) == near(0.784e9, {.relative = 1e-12}));
    CHECK(repaired(hollow).warnings.empty());
    CHECK(volume_um3(repaired(turned_inside_out(hollow)).surface) == near(0.784e9, {.relative = 1e-12}));
}

TEST_CASE("repeated and degenerate triangles do not change the volume") {
    TriMesh mesh = cube;
    mesh.triangles.push_back(mesh.triangles[4]);
    add_triangle(mesh, {0, 0, 0}, {0, 0, 0}, {1000, 0, 0});
    add_triangle(mesh, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
    add_triangle(mesh, {0, 0, 0}, {1000, 1000, 1000}, {500, 500, 500});
    const Repaired r = repaired(mesh);
    CHECK(volume_um3(r.surface) == near(1e9, {.relative = 1e-12}));
}

TEST_CASE("two cubes that share an edge are two shells") {
    const Repaired r = repaired(together(cube, box({1000, 1000, 0}, {2000, 2000, 1000})));
    CHECK(find_shells(r.surface, edge_uses(r.surface.triangles)).count == 2);
    CHECK(volume_um3(r.surface) == near(2e9, {.relative = 1e-12}));
}

TEST_CASE("invalid solids are refused with the reason") {
    TriMesh sheet;
    add_triangle(sheet, {0, 0, 0}, {1000, 0, 0}, {1000, 1000, 0});
    add_triangle(sheet, {0, 0, 0}, {1000, 1000, 0}, {0, 1000, 0});
    CHECK(refused_mesh(sheet).find("the surface is open: 1 mm^2 are missing beside 1 mm^2") != std::string::npos);
    CHECK(refused_mesh(together(sheet, turned_inside_out(sheet))).find("encloses no volume") != std::string::npos);
    CHECK(refused_mesh(TriMesh{}).find("no triangle") != std::string::npos);

    TriMesh bad = cube;
    bad.points[7].y = std::nan("");
    CHECK(refused_mesh(bad).find("point 7 is not finite") != std::string::npos);
    bad.points[7].y = 1e10;
    CHECK(refused_mesh(bad).find("more than 2 m") != std::string::npos);
    bad = cube;
    bad.triangles[5][1] = 999;
    CHECK(refused_mesh(bad) == "body 'b' (soft): triangle 5 names point 999, there are 36");
    bad.triangles[5][1] = -1;
    CHECK(refused_mesh(bad).find("names point -1") != std::string::npos);
}
