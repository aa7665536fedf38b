#include "printing/slice/arrange.hpp"

#include <doctest/doctest.h>

#include "printing/slice/place.hpp"
#include "printing/slice/slicer.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

TEST_CASE("a part is rotated about x, then y, then z") {
    std::vector<Body> bodies{{"soft", box({0, 0, 0}, {1000, 2000, 3000}), "a"}};
    REQUIRE(turn(bodies, {90, 0, 90}).has_value());  // y to z, z to -y; then x to y, -y to x
    const Box3 box = mesh::bounds(bodies[0].surface_um);
    CHECK(box.low == Vec3{0, 0, 0});
    CHECK(box.high == Vec3{3000, 1000, 2000});
    std::vector<Body> slices{{"soft", {}, "s", {{0, 50, {{{0, 0}, {100, 0}, {0, 100}}}}}}};
    REQUIRE(turn(slices, {0, 0, 90}).has_value());
    CHECK(slices[0].slices[0].outlines_um[0][1] == std::array<double, 2>{0, 100});
    CHECK(turn(slices, {90, 0, 0}).error().message ==
          "body 's' (soft): consists of slices, which can be turned about z only");
}

TEST_CASE("scaling a part scales surfaces, slices and blends") {
    std::vector<Body> bodies{{"soft", box({-1000, 0, 0}, {1000, 2000, 3000}), "a"},
                             {"soft", {}, "s", {{100, 150, {{{0, 0}, {100, 0}, {0, 100}}}}}}};
    bodies[0].blend = Blend{"firm", {0, 0, 0}, {0, 0, 3000}};
    REQUIRE(scale(bodies, 1.5).has_value());
    CHECK(mesh::bounds(bodies[0].surface_um).low == Vec3{-1500, 0, 0});
    CHECK(mesh::bounds(bodies[0].surface_um).high == Vec3{1500, 3000, 4500});
    CHECK(bodies[0].blend->to_um == Vec3{0, 0, 4500});
    CHECK(bodies[1].slices[0].top_um == 225);
    CHECK(bodies[1].slices[0].outlines_um[0][1] == std::array<double, 2>{150, 0});
    CHECK(scale(bodies, 0).error().message == "a scale of 0: must be 0.001 to 1000");
    CHECK(scale(bodies, 1001).error().message == "a scale of 1001: must be 0.001 to 1000");
}

TEST_CASE("copies stand in the room that a turned image covers") {
    Raster raster{64, 48, 100};
    raster.rotation_deg = 90;  // 4.8 x 6.4 mm
    std::vector<Body> bodies{{"soft", box({0, 0, 0}, {4800, 1000, 100}), "a"}};
    CHECK(repeat(bodies, 6, 0, raster).has_value());
    bodies.resize(1);
    CHECK(repeat(bodies, 7, 0, raster).error().message ==
          "7 copies of 4.800 x 1.000 mm, 0.000 mm apart, do not fit an image of 4.800 x 6.400 mm: 6 do");
}

TEST_CASE("the number of copies in an image that is turned or off the platform's middle can be attained") {
    Raster raster{64, 48, 100};
    const std::vector<Body> one{{"soft", box({0, 0, 0}, {1000, 1000, 100}), "a"}};
    const auto refused = [&](int count) {
        std::vector<Body> bodies = one;
        const Status made = repeat(bodies, count, 0, raster);
        return made ? std::string() : made.error().message;
    };
    raster.rotation_deg = 45;
    // A grid of n x m fits where (n + m) / sqrt(2) is at most 4.8: three by three.
    CHECK(refused(10) ==
          "10 copies of 1.000 x 1.000 mm, 0.000 mm apart, do not fit an image of 7.920 x 7.920 mm: 9 do");
    std::vector<Body> bodies = one;
    REQUIRE(repeat(bodies, 9, 0, raster).has_value());
    REQUIRE(place_on_platform(bodies, raster).has_value());
    CHECK(Slicer::prepare(bodies, {raster, 50, {}}).has_value());
    raster.rotation_deg = 0;
    raster.offset_x_um = -1200;
    raster.offset_y_um = 500;
    CHECK(refused(13) ==
          "13 copies of 1.000 x 1.000 mm, 0.000 mm apart, do not fit an image around the middle of the platform of "
          "4.000 x 3.800 mm: 12 do");
    bodies = one;
    REQUIRE(repeat(bodies, 12, 0, raster).has_value());
    REQUIRE(place_on_platform(bodies, raster).has_value());
    CHECK(Slicer::prepare(bodies, {raster, 50, {}}).has_value());
}

TEST_CASE("copies are arranged in rows; too many are refused with the number that fits") {
    const Raster raster{64, 48, 100};  // 6.4 x 4.8 mm
    std::vector<Body> bodies{{"soft", box({0, 0, 0}, {1800, 1000, 100}), "a"}};
    const std::vector<Body> one = bodies;
    REQUIRE(repeat(bodies, 5, 500, raster).has_value());  // three in a row: 3 * 1.8 + 2 * 0.5 = 6.4
    REQUIRE(bodies.size() == 5);
    CHECK(bodies[4].name == "a #5");
    CHECK(mesh::bounds(bodies[2].surface_um).high == Vec3{6400, 1000, 100});
    CHECK(mesh::bounds(bodies[4].surface_um).low == Vec3{2300, 1500, 0});
    bodies = one;
    CHECK(repeat(bodies, 10, 500, raster).error().message ==
          "10 copies of 1.800 x 1.000 mm, 0.500 mm apart, do not fit an image of 6.400 x 4.800 mm: 9 do");
    CHECK(bodies.size() == 1);
    CHECK(!repeat(bodies, 0, 500, raster).has_value());
    CHECK(!repeat(bodies, 2, -1, raster).has_value());
}

TEST_CASE("copies of a flat part, and copies without spacing, are made") {
    const Raster raster{64, 48, 100};
    mesh::TriMesh flat;
    add_triangle(flat, {0, 0, 0}, {0, 1000, 0}, {0, 0, 1000});
    std::vector<Body> bodies{{"soft", flat, "a"}};
    REQUIRE(repeat(bodies, 100, 0, raster).has_value());
    CHECK(bodies.size() == 100);
    CHECK(bodies[99].surface_um.points[0] == Vec3{0, 0, 0});
}
