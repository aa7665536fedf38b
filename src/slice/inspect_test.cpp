#include "slice/inspect.hpp"

#include <doctest/doctest.h>

#include "slice/slicer.hpp"
#include "slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

namespace {

const Raster raster{64, 48, 100};

Findings findings_of(const std::vector<Body>& bodies) {
    const auto slicer = Slicer::prepare(bodies, {raster, 50, {}});
    REQUIRE_MESSAGE(slicer.has_value(), (slicer ? "" : slicer.error().message));
    Inspector inspector;
    for (int k = 0; k < slicer->layer_count(); ++k) inspector.add(shape_of(slicer->layer(k), raster.width_px));
    return inspector.finish();
}

Body solid(const Vec3& low, const Vec3& high) {
    return {"soft", box(low, high), ""};
}

}  // namespace

TEST_CASE("a block has neither islands nor cavities and is one piece") {
    const Findings f = findings_of({solid({-1000, -1000, 0}, {1000, 1000, 500})});
    CHECK(f.islands.empty());
    CHECK(f.cavities.empty());
    REQUIRE(f.pieces.size() == 1);
    CHECK(f.pieces[0].voxels == 4000);
    CHECK(f.faint_layers.empty());
    CHECK(describe(f, raster).empty());
}

TEST_CASE("a part of a table that begins below the top is an island, its legs are not") {
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
    CHECK(describe(f, raster).at(0).find("1 islands begin in mid-air, in 1 layers from 4 to 4") == 0);
}

TEST_CASE("closed cavities, cups and tunnels are told apart") {
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
    // With a slit under one wall it is vented from the start.
    f = findings_of(pot(150));
    CHECK(f.cavities.empty());
    // A tunnel from the platform to the top is a cup too: the platform closes it.
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

TEST_CASE("pieces that touch nowhere are counted") {
    const Findings f =
        findings_of({solid({-1000, -1000, 0}, {-500, 1000, 500}), solid({500, -1000, 0}, {1000, 1000, 300})});
    REQUIRE(f.pieces.size() == 2);
    CHECK(f.pieces[1].last_layer == 5);
    CHECK(f.islands.empty());
}

TEST_CASE("layers of hairs are called faint") {
    const Findings f =
        findings_of({solid({-1000, -1000, 0}, {1000, 1000, 200}), solid({10, -1000, 200}, {40, 1000, 300})});
    CHECK(f.faint_layers == std::vector<int>{4, 5});
}
