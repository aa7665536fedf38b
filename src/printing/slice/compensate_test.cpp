#include "printing/slice/compensate.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

#include "base/core/near.hpp"
#include "printing/slice/slicer.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

namespace {

SlicedLayer cut(const std::vector<Body>& bodies, const std::map<std::string, Compensation>& compensation, int layer,
                const ComposeRules& rules = {}) {
    Settings settings{small_raster, 50, rules};
    settings.compensation = compensation;
    const auto slicer = Slicer::prepare(bodies, settings);
    REQUIRE(slicer.has_value());
    return slicer->layer(layer);
}

/// In pixels.
double area(const SlicedLayer& layer, int material) {
    for (const MaterialImage& m : layer.images) {
        if (m.material == material) return static_cast<double>(m.value_sum) / 255;
    }
    return 0;
}

const std::vector<Body> square{{"soft", box({-1000, -1000, 0}, {1000, 1000, 500}), ""}};  // 20 x 20 px
const std::vector<Body> halves{{"soft", box({-1000, -1000, 0}, {0, 1000, 500}), ""},
                               {"rigid", box({0, -1000, 0}, {1000, 1000, 500}), ""}};

}  // namespace

TEST_CASE("a square shrinks and grows by the given offset") {
    CHECK(area(cut(square, {}, 0), 0) == 400);
    CHECK(area(cut(square, {{"soft", {-100}}}, 0), 0) == near(18 * 18, {.relative = 1e-12}));
    CHECK(area(cut(square, {{"soft", {-50}}}, 0), 0) == near(19 * 19, {.relative = 0.001}));
    const double grown = 20 * 20 + 4 * 20 * 2 + std::numbers::pi * 2 * 2;
    CHECK(area(cut(square, {{"soft", {200}}}, 0), 0) == near(grown, {.relative = 0.001}));
    CHECK(area(cut(square, {{"other", {200}}}, 0), 0) == 400);
}

TEST_CASE("a disc and a hole move by the same offset") {
    auto disc = prism(regular_polygon(256, 1500), 0, 500);
    const auto pi = std::numbers::pi;
    for (const double um : {-300.0, -125.0, 75.0, 250.0}) {
        const double r = 15 + um / 100;
        CHECK(area(cut({{"soft", disc, ""}}, {{"soft", {um}}}, 3), 0) == near(pi * r * r, {.relative = 0.004}));
    }
    const Body ring{"soft", together(disc, turned_inside_out(prism(regular_polygon(256, 700), 0, 500))), ""};
    CHECK(area(cut({ring}, {{"soft", {-100}}}, 3), 0) == near(pi * (14 * 14 - 8 * 8), {.relative = 0.006}));
}

TEST_CASE("borders between materials stay, each material has its own offset, and no pixel is lit twice") {
    const SlicedLayer layer = cut(halves, {{"soft", {-100}}, {"rigid", {200}}}, 0);
    CHECK(area(layer, 0) >= 9 * 18);
    const RunImage &soft = layer.images[0].image, &rigid = layer.images[1].image;
    CHECK(soft.row(24).front() == Run{23, 32, 255});
    CHECK(rigid.row(24).front() == Run{32, 44, 255});
    for (int row = 0; row < small_raster.height_px; ++row) {
        for (int column = 0; column < small_raster.width_px; ++column)
            CHECK((soft.at(row, column) == 0 || rigid.at(row, column) == 0));
    }
}

TEST_CASE("elephant-foot compensation shrinks the first layers only") {
    const std::map<std::string, Compensation> foot{{"soft", {0, 200, 2}}};
    CHECK(area(cut(square, foot, 0), 0) == near(16 * 16, {.relative = 1e-12}));
    CHECK(area(cut(square, foot, 1), 0) == near(18 * 18, {.relative = 1e-12}));
    CHECK(area(cut(square, foot, 2), 0) == 400);
}

TEST_CASE("a wall thinner than twice the offset disappears; a gap between materials closes before the offset") {
    CHECK(area(cut({{"soft", box({-60, -1000, 0}, {60, 1000, 500}), ""}, square[0]}, {}, 0), 0) == 400);
    const std::vector<Body> wall{{"soft", box({-60, -1000, 0}, {60, 1000, 500}), ""},
                                 {"rigid", box({1000, -1000, 0}, {1500, 1000, 500}), ""}};
    CHECK(area(cut(wall, {{"soft", {-70}}}, 0), 0) == 0);
    const std::vector<Body> gap{{"soft", box({-1000, -1000, 0}, {0, 1000, 500}), ""},
                                {"rigid", box({15, -1000, 0}, {1000, 1000, 500}), ""}};
    const SlicedLayer layer = cut(gap, {{"soft", {-100}}, {"rigid", {-100}}}, 0);
    CHECK(layer.closed_gap_pixels > 0);
    CHECK(area(layer, 0) + area(layer, 1) == near(18 * 18, {.relative = 1e-12}));
}

TEST_CASE("without anti-aliasing compensated pixels stay full or black") {
    const SlicedLayer layer = cut(square, {{"soft", {-30}}}, 0, {false, 0.5, 20});
    CHECK(area(layer, 0) == 396);  // of a corner's pixel (11/16)^2 are left, less than half
    CHECK(area(cut(square, {{"soft", {-60}}}, 0, {false, 0.5, 20}), 0) == 18 * 18);
}

TEST_CASE("invalid offsets are refused with the material's name") {
    Settings settings{small_raster, 50, {}};
    settings.compensation["soft"] = {0, -5, 2};
    CHECK(Slicer::prepare(square, settings).error().message ==
          "material 'soft': elephant foot of -5 um: must be 0 to 10000 um");
    settings.compensation["soft"] = {2e4};
    CHECK(Slicer::prepare(square, settings).error().message ==
          "material 'soft': XY compensation of 20000 um: must be -10000 to 10000 um");
}

TEST_CASE("bleed compensation does not take the ring that the elephant foot leaves out for an underside") {
    // 20 px wide; 2 px less on each side in the first layer, half a pixel less in every one above it. A half-lit pixel
    // has the grey 128 of 255.
    for (int k = 0; k < 5; ++k) {
        const double side = 20 - 2 * 0.5 * std::max(0, 4 - k);
        const double plain = area(cut(square, {{"soft", {0, 200, 4, 0}}}, k), 0);
        CHECK(plain == near(side * side, {.relative = 0.001}));
        for (const double bleed_um : {26.0, 60.0, 100.0}) {
            CAPTURE(bleed_um);
            CHECK(area(cut(square, {{"soft", {0, 200, 4, bleed_um}}}, k), 0) == plain);
        }
    }
    // An underside of the drawing begins higher all the same, on the foot and beside it.
    const std::vector<Body> tee{{"soft", box({-1000, -1000, 0}, {1000, 1000, 100}), ""},
                                {"soft", box({-1000, -1000, 100}, {1500, 1000, 500}), ""}};
    CHECK(area(cut(tee, {{"soft", {0, 200, 4, 60}}}, 2), 0) == near(19 * 18, {.relative = 1e-12}));
    CHECK(area(cut(tee, {{"soft", {0, 200, 4, 60}}}, 4), 0) == near(25 * 20, {.relative = 1e-12}));
}
