#include "printing/slice/inspect.hpp"

#include <doctest/doctest.h>

#include "printing/slice/slicer.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

namespace {

Findings findings_of(const std::vector<Body>& bodies) {
    const auto slicer = Slicer::prepare(bodies, {small_raster, 50, {}});
    REQUIRE_MESSAGE(slicer.has_value(), (slicer ? "" : slicer.error().message));
    Inspector inspector;
    for (int k = 0; k < slicer->layer_count(); ++k) inspector.add(shape_of(slicer->layer(k), small_raster.width_px));
    return inspector.finish();
}

Body solid(const Vec3& low, const Vec3& high) {
    return {"soft", box(low, high), ""};
}

}  // namespace

TEST_CASE("a block has no islands or cavities, and is one component") {
    const Findings f = findings_of({solid({-1000, -1000, 0}, {1000, 1000, 500})});
    CHECK(f.islands.empty());
    CHECK(f.cavities.empty());
    REQUIRE(f.pieces.size() == 1);
    CHECK(f.pieces[0].voxels == 4000);
    CHECK(f.faint_layers.empty());
    CHECK(describe(f, small_raster).empty());
}

TEST_CASE("a part of a table that hangs below its plate is an island; legs are not") {
    // Two legs, a plate on top, and a stalactite that begins in layer 4 and meets the plate in layer 8.
    const Findings f =
        findings_of({solid({-2000, -500, 0}, {-1500, 500, 400}), solid({1500, -500, 0}, {2000, 500, 400}),
                     solid({-2000, -500, 400}, {2000, 500, 500}), solid({0, -100, 200}, {200, 100, 400})});
    REQUIRE(f.islands.size() == 1);
    CHECK(f.islands[0].layer == 4);
    CHECK(f.islands[0].row == 23);
    CHECK(f.islands[0].column == 32);
    CHECK(f.islands[0].pixels == 4);
    CHECK(f.pieces.size() == 1);
    CHECK(f.cavities.empty());
    CHECK(describe(f, small_raster)
              .at(0)
              .starts_with("an island begins in mid-air in layer 5, held from layer 9 on: up to 0.04"));
}

TEST_CASE("closed cavities, cups and tunnels are distinguished") {
    const mesh::TriMesh cube = box({-1000, -1000, 0}, {1000, 1000, 500});
    // Closed: layers 2 to 7.
    Findings f =
        findings_of({{"soft", together(cube, turned_inside_out(box({-600, -600, 100}, {600, 600, 400}))), ""}});
    REQUIRE(f.cavities.size() == 1);
    CHECK(f.cavities[0].end == Cavity::End::closed);
    CHECK(f.cavities[0].first_layer == 2);
    CHECK(f.cavities[0].last_layer == 7);
    CHECK(f.cavities[0].voxels == 144 * 6);
    // A pot, open at the top: floor in layers 0 and 1, walls from four boxes.
    const auto pot = [](double wall_bottom) {
        return std::vector<Body>{
            solid({-1000, -1000, 0}, {1000, 1000, 100}), solid({-1000, -1000, wall_bottom}, {-600, 1000, 500}),
            solid({600, -1000, 100}, {1000, 1000, 500}), solid({-600, -1000, 100}, {600, -600, 500}),
            solid({-600, 600, 100}, {600, 1000, 500})};
    };
    f = findings_of(pot(100));
    REQUIRE(f.cavities.size() == 1);
    CHECK(f.cavities[0].end == Cavity::End::last_layer);
    CHECK(f.cavities[0].voxels == 144 * 8);
    // With a slit under one wall it is vented from the beginning.
    f = findings_of(pot(150));
    CHECK(f.cavities.empty());
    // A tunnel from the platform to the top is a cup, too: the platform closes it.
    f = findings_of({solid({-1000, -1000, 0}, {-600, 1000, 200}), solid({600, -1000, 0}, {1000, 1000, 200}),
                     solid({-600, -1000, 0}, {600, -600, 200}), solid({-600, 600, 0}, {600, 1000, 200})});
    REQUIRE(f.cavities.size() == 1);
    CHECK(f.cavities[0].end == Cavity::End::last_layer);
    CHECK(f.cavities[0].first_layer == 0);
    // Walls that end before the part does open the cup.
    std::vector<Body> opened = pot(100);
    opened.push_back(solid({-1000, -1000, 500}, {-600, 1000, 600}));
    f = findings_of(opened);
    REQUIRE(f.cavities.size() == 1);
    CHECK(f.cavities[0].end == Cavity::End::opened);
    CHECK(f.cavities[0].last_layer == 9);
}

TEST_CASE("separate components are counted") {
    const Findings f =
        findings_of({solid({-1000, -1000, 0}, {-500, 1000, 500}), solid({500, -1000, 0}, {1000, 1000, 300})});
    REQUIRE(f.pieces.size() == 2);
    CHECK(f.pieces[1].last_layer == 5);
    CHECK(f.islands.empty());
}

TEST_CASE("layers with faint pixels only are reported") {
    const Findings f =
        findings_of({solid({-1000, -1000, 0}, {1000, 1000, 200}), solid({10, -1000, 200}, {40, 1000, 300})});
    CHECK(f.faint_layers == std::vector<int>{4, 5});
}

TEST_CASE("islands that join before they are supported are one group") {
    // A table with its plate at layer 8; below hangs a comb: three teeth in layers 2 and 3, joined by a bar in layers 4
    // to 7, unsupported before layer 8. A second plate, never supported, floats beside it.
    const Findings f =
        findings_of({solid({-2000, -500, 0}, {-1500, 500, 400}), solid({1500, -500, 0}, {2000, 500, 400}),
                     solid({-2000, -500, 400}, {2000, 500, 500}), solid({-600, -100, 100}, {-400, 100, 200}),
                     solid({-100, -100, 100}, {100, 100, 200}), solid({400, -100, 100}, {700, 100, 200}),
                     solid({-600, -100, 200}, {700, 100, 400}), solid({0, 1000, 50}, {1000, 2000, 100})});
    CHECK(f.islands.size() == 4);
    REQUIRE(f.groups.size() == 2);
    const IslandGroup &comb = f.groups[0], &plate = f.groups[1];
    CHECK(plate.islands == 1);
    CHECK(plate.held_layer == -1);
    CHECK(plate.voxels == 100);
    CHECK(plate.severity == Severity::high);
    CHECK(comb.islands == 3);
    CHECK(comb.first_layer == 2);
    CHECK(comb.last_layer == 7);
    CHECK(comb.held_layer == 8);
    CHECK(comb.largest.pixels == 6);
    CHECK(comb.most_pixels == 26);
    CHECK(comb.voxels == 2 * (4 + 4 + 6) + 4 * 26);
    CHECK(comb.severity == Severity::high);
    const std::vector<std::string> lines = describe(f, small_raster);
    REQUIRE(lines.size() == 2);
    CHECK(lines[1].starts_with("an island begins in mid-air in layer 2, and nothing ever holds it: up to 1 mm^2, at"));
    CHECK(lines[0].starts_with(
        "3 islands that grow together begin in mid-air in layer 3, held from layer 9 on: up to 0.26"));
}

TEST_CASE("islands of raster size take one line, whatever their number, and hide no larger island") {
    std::vector<Body> bodies{solid({-3000, -2000, 0}, {3000, 2000, 100})};
    // A ceiling on four walls, with specks of a pixel in the layer below it, and a ledge of 2 x 1 mm that begins there
    // too.
    for (const double x : {-3000.0, 2500.0}) bodies.push_back(solid({x, -2000, 100}, {x + 500, 2000, 500}));
    bodies.push_back(solid({-3000, -2000, 500}, {3000, 2000, 600}));
    int specks = 0;
    for (double x = -2400; x < 0; x += 300) {
        for (double y = -1900; y < 1900; y += 300, ++specks)
            bodies.push_back(solid({x, y, 450}, {x + 100, y + 100, 500}));
    }
    bodies.push_back(solid({200, -500, 450}, {2200, 500, 500}));
    bodies.push_back(solid({200, 1000, 300}, {400, 1200, 500}));
    const Findings f = findings_of(bodies);
    CHECK(f.islands.size() == static_cast<std::size_t>(specks + 2));
    REQUIRE(f.groups.size() == static_cast<std::size_t>(specks + 2));
    CHECK(f.groups[0].severity == Severity::high);
    CHECK(f.groups[0].first_layer == 6);
    CHECK(f.groups[1].severity == Severity::medium);
    CHECK(f.groups[1].most_pixels == 200);
    CHECK(f.groups[2].severity == Severity::low);
    CHECK(f.groups.back().severity == Severity::low);
    const std::vector<std::string> lines = describe(f, small_raster);
    REQUIRE(lines.size() == 3);
    CHECK(lines[0].starts_with("an island begins in mid-air in layer 7, held from layer 11 on: up to 0.04 mm^2"));
    CHECK(lines[1].starts_with("1 island in mid-air, held within two layers, in layer 10; the largest, 2 mm^2"));
    CHECK(lines[2].starts_with(
        fmt::format("{} islands in mid-air of a few pixels, the grain of the raster, in layer 10", specks)));
}
