#include "printing/slice/thin.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "printing/slice/slicer.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

namespace {

const Raster fine_raster{128, 96, 50};  // 6.4 x 4.8 mm

std::vector<ThinSpot> thin_in(const std::vector<Body>& bodies, double least_um) {
    const auto slicer = Slicer::prepare(bodies, {fine_raster, 50, {}});
    REQUIRE(slicer.has_value());
    return thin_spots(slicer->layer(0), 0, least_um, fine_raster);
}

}  // namespace

TEST_CASE("a wall of 0.2 mm is thinner than 0.3 mm and not than 0.2 mm") {
    const std::vector<Body> wall{{"soft", box({-1000, -100, 0}, {1000, 100, 500}), ""}};
    const auto spots = thin_in(wall, 300);
    REQUIRE(spots.size() == 1);
    CHECK(spots[0].pixels == 40 * 4);
    CHECK(spots[0].row == 46);
    CHECK(spots[0].column == 44);
    CHECK(describe(spots, {"soft"}, 300, fine_raster).front() ==
          "material \"soft\": 1 feature narrower than 0.3 mm in layer 1; the largest, 0.4 mm^2, begins in layer 1 "
          "at row 46, column 44");
    CHECK(thin_in({{"soft", box({-1000, -150, 0}, {1000, 150, 500}), ""}}, 250).empty());
    CHECK(thin_in(wall, 50).empty());
}

TEST_CASE("walls are measured alike at every angle: to a pixel") {
    const auto found = [](double width_um, double degrees, double shift_um) {
        const double a = degrees * std::numbers::pi / 180, x = 1500 * std::cos(a), y = 1500 * std::sin(a);
        const double u = -width_um / 2 * std::sin(a), v = width_um / 2 * std::cos(a);
        std::vector<Point2> wall{{-x - u, -y - v}, {x - u, y - v}, {x + u, y + v}, {u - x, v - y}};
        for (Point2& corner : wall) corner.x += shift_um;
        return !thin_in({{"soft", prism(wall, 0, 500), ""}}, 300).empty();
    };
    for (double degrees = 0; degrees < 180; degrees += 7.5) {
        for (const double shift_um : {0.0, 13.0, 25.0}) {
            CAPTURE(degrees);
            CAPTURE(shift_um);
            for (const double width_um : {100.0, 150.0, 200.0, 250.0}) CHECK(found(width_um, degrees, shift_um));
            CHECK(!found(301, degrees, shift_um));
        }
    }
}

TEST_CASE("corners, discs and triangles are not thin; a fin on a block and the tip of a needle are") {
    CHECK(thin_in({{"soft", box({-1000, -1000, 0}, {1000, 1000, 500}), ""}}, 400).empty());
    CHECK(thin_in({{"soft", prism(regular_polygon(4, 1500, 0.3), 0, 500), ""}}, 400).empty());
    CHECK(thin_in({{"soft", prism(regular_polygon(64, 1500), 0, 500), ""}}, 400).empty());
    const std::vector<Body> fin{{"soft", box({-1000, -1000, 0}, {0, 1000, 500}), ""},
                                {"soft", box({0, -50, 0}, {1500, 50, 500}), ""}};
    REQUIRE(thin_in(fin, 400).size() == 1);
    CHECK(thin_in(fin, 400)[0].pixels > 0.7 * 30 * 2);
    CHECK(thin_in({{"soft", prism({{-1500, -200}, {1500, 0}, {-1500, 200}}, 0, 500), ""}}, 300).size() == 1);
}

TEST_CASE("walls are features of their own, from their first layer to their last") {
    // Two walls beside a block, of which the second begins higher.
    const auto slicer = Slicer::prepare(std::vector<Body>{{"soft", box({-1500, -1000, 0}, {-500, 1000, 500}), ""},
                                                          {"soft", box({0, -1000, 0}, {100, 1000, 500}), ""},
                                                          {"soft", box({1000, -500, 200}, {1100, 500, 500}), ""}},
                                        {fine_raster, 50, {}});
    REQUIRE(slicer.has_value());
    std::vector<ThinSpot> all;
    for (int k = 0; k < slicer->layer_count(); ++k) {
        const auto own = thin_spots(slicer->layer(k), k, 300, fine_raster);
        all.insert(all.end(), own.begin(), own.end());
    }
    const std::vector<ThinSpot> features = joined(all);
    REQUIRE(features.size() == 2);
    CHECK(features[0].layer == 0);
    CHECK(features[1].layer == 4);
    for (const ThinSpot& feature : features) CHECK(feature.last_layer == 9);
    CHECK(features[0].pixels == 2 * 40);
    CHECK(features[1].pixels == 2 * 20);
}

TEST_CASE("thin features are found per material") {
    const std::vector<Body> sandwich{{"soft", box({-1000, -1000, 0}, {0, 1000, 500}), ""},
                                     {"rigid", box({0, -1000, 0}, {100, 1000, 500}), ""},
                                     {"soft", box({100, -1000, 0}, {1000, 1000, 500}), ""}};
    const auto spots = thin_in(sandwich, 300);
    REQUIRE(spots.size() == 1);
    CHECK(spots[0].material == 1);
    CHECK(spots[0].pixels == 2 * 40);
}
