#include "printing/slice/teeth.hpp"

#include <doctest/doctest.h>

#include "printing/slice/slicer.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

namespace {

const std::vector<Body> soft_and_rigid{{"soft", box({-1050, -1000, 0}, {0, 1000, 500}), ""},
                                       {"rigid", box({0, -1000, 0}, {1000, 1000, 500}), ""}};

Slicer slicer_with(const std::vector<Body>& bodies, const std::vector<Teeth>& teeth) {
    Settings settings{small_raster, 50, {}};
    settings.teeth = teeth;
    auto slicer = Slicer::prepare(bodies, settings);
    REQUIRE_MESSAGE(slicer.has_value(), (slicer ? "" : slicer.error().message));
    return std::move(*slicer);
}

std::string refused_teeth(const Teeth& teeth) {
    Settings settings{small_raster, 50, {}};
    settings.teeth = {teeth};
    const auto slicer = Slicer::prepare(soft_and_rigid, settings);
    return slicer ? "" : slicer.error().message;
}

}  // namespace

TEST_CASE("two halves interlock by three pixels, alternating every two layers, and the total light is kept") {
    const Slicer slicer = slicer_with(soft_and_rigid, {{"soft", "rigid", 3, 2}});
    const SlicedLayer plain = slicer_with(soft_and_rigid, {}).layer(0);
    for (int k = 0; k < 10; ++k) {
        const SlicedLayer layer = slicer.layer(k);
        REQUIRE(layer.images.size() == 2);
        const int border = k / 2 % 2 == 0 ? 35 : 29;
        for (int row = 14; row < 34; ++row) {
            const auto soft = layer.images[0].image.row(row), rigid = layer.images[1].image.row(row);
            REQUIRE(soft.size() == 2);
            CHECK(soft[0] == Run{21, 22, 128});
            CHECK(soft[1] == Run{22, static_cast<std::uint16_t>(border), 255});
            REQUIRE(rigid.size() == 1);
            CHECK(rigid[0] == Run{static_cast<std::uint16_t>(border), 42, 255});
        }
        CHECK(layer.images[0].value_sum + layer.images[1].value_sum ==
              plain.images[0].value_sum + plain.images[1].value_sum);
    }
}

TEST_CASE("a wall thinner than the teeth is missing in every other layer; bodies that do not touch stay") {
    const std::vector<Body> bodies{{"soft", box({-1000, -1000, 0}, {0, 1000, 500}), ""},
                                   {"rigid", box({0, -1000, 0}, {200, 1000, 500}), ""},
                                   {"tough", box({1000, -1000, 0}, {1500, 1000, 500}), ""}};
    const Slicer slicer = slicer_with(bodies, {{"soft", "rigid", 3, 1}, {"soft", "tough", 3, 1}});
    REQUIRE(slicer.layer(0).images.size() == 2);
    CHECK(slicer.layer(0).images[0].value_sum == 12 * 20 * 255);
    CHECK(slicer.layer(0).images[1].material == 2);
    CHECK(slicer.layer(1).images.size() == 3);
    CHECK(slicer.layer(1).images[1].value_sum == 5 * 20 * 255);
}

TEST_CASE("invalid teeth are refused") {
    CHECK(refused_teeth({"soft", "soft", 3, 1}) == "interlock 'soft' with 'soft': two different materials are needed");
    CHECK(refused_teeth({"soft", "rigid", 0, 1}) ==
          "interlock 'soft' with 'rigid': depth of 0 pixels: must be 1 to 1000");
    CHECK(refused_teeth({"soft", "rigid", 2, 0}) == "interlock 'soft' with 'rigid': 0 layers: must be 1 to 10000");
    CHECK(refused_teeth({"soft", "tough", 2, 1}) ==
          "interlock 'soft' with 'tough': there is no material 'tough', only soft and rigid");
}
