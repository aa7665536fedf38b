#include "printing/slice/bond.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "printing/slice/inspect.hpp"
#include "printing/slice/slicer.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

namespace {

Settings with_bond(const Bond& bond) {
    Settings settings{small_raster, 50, {}};
    settings.bonds = {bond};
    return settings;
}

}  // namespace

TEST_CASE("a bond lights a strip of the neighbour too, and the owner of pixels does not change") {
    const std::vector<Body> halves{{"soft", box({-2000, -1000, 0}, {0, 1000, 200}), ""},
                                   {"firm", box({0, -1000, 0}, {2000, 1000, 200}), ""}};
    const auto slicer = Slicer::prepare(halves, with_bond({"soft", "firm", 3, 0}));
    REQUIRE(slicer.has_value());
    const SlicedLayer layer = slicer->layer(1);
    REQUIRE(layer.images.size() == 2);
    CHECK(layer.images[0].value_sum == 255 * (400 + 60));
    CHECK(layer.images[0].shared_sum == 255 * 60);
    CHECK(layer.images[1].value_sum == 255 * 400);
    CHECK(layer.images[1].shared_sum == 0);
    CHECK(layer.images[0].image.at(24, 34) == 255);
    CHECK(layer.images[0].image.at(24, 35) == 0);
}

TEST_CASE("the inspection counts a pixel lit twice once") {
    const std::vector<Body> halves{{"soft", box({-2000, -1000, 0}, {0, 1000, 200}), ""},
                                   {"firm", box({0, -1000, 0}, {2000, 1000, 200}), ""}};
    const auto slicer = Slicer::prepare(halves, with_bond({"soft", "firm", 3, 0}));
    REQUIRE(slicer.has_value());
    Inspector inspector;
    for (int k = 0; k < 4; ++k) inspector.add(shape_of(slicer->layer(k), small_raster.width_px));
    const Findings findings = inspector.finish();
    CHECK(findings.islands.empty());
    CHECK(findings.cavities.empty());
    REQUIRE(findings.pieces.size() == 1);
    CHECK(findings.pieces[0].voxels == 4 * 800);
}

TEST_CASE("a bond over layers lights the area of contact just above and below") {
    const std::vector<Body> stacked{{"soft", box({-1000, -1000, 0}, {1000, 1000, 200}), ""},
                                    {"firm", box({-500, -500, 200}, {500, 500, 400}), ""}};
    const auto slicer = Slicer::prepare(stacked, with_bond({"soft", "firm", 0, 2}));
    REQUIRE(slicer.has_value());
    for (int k = 0; k < 8; ++k) {
        std::int64_t shared = 0;
        for (const MaterialImage& m : slicer->layer(k).images) shared += m.shared_sum;
        CHECK(shared == (k == 4 || k == 5 ? 255 * 100 : 0));
    }
    const auto refused = Slicer::prepare(stacked, with_bond({"soft", "fim", 1, 0}));
    REQUIRE(!refused.has_value());
    CHECK(refused.error().message == "overlap 'soft' with 'fim': there is no material 'fim', only soft and firm");
    CHECK(!Slicer::prepare(stacked, with_bond({"soft", "firm", 0, 0})).has_value());
}

TEST_CASE("pairs that meet nowhere are told of, once for all that stand for one option") {
    // From left to right "soft", "soft of q", "firm" and, further away, "hard".
    const std::vector<Body> row{{"soft", box({-2000, -500, 0}, {-1000, 500, 100}), ""},
                                {"soft of q", box({-1000, -500, 0}, {0, 500, 100}), ""},
                                {"firm", box({0, -500, 0}, {1000, 500, 100}), ""},
                                {"hard", box({1500, -500, 0}, {2000, 500, 100}), ""}};
    const auto told = [&](const std::vector<Bond>& bonds, const std::vector<Teeth>& teeth) {
        Settings settings{small_raster, 50, {}};
        settings.bonds = bonds;
        settings.teeth = teeth;
        Progress silent;
        const auto summary = slice_bodies(
            row, settings, [](int, int, const RunImage&) { return Status{}; }, silent);
        REQUIRE(summary.has_value());
        return summary->warnings;
    };
    CHECK(told({{"soft of q", "firm", 3, 0}}, {{"firm", "soft of q", 2, 1}}).empty());
    CHECK(told({{"soft", "firm", 3, 0}}, {}) ==
          std::vector<std::string>{"overlap: soft and firm meet nowhere, no pixel is exposed twice"});
    CHECK(told({}, {{"firm", "hard", 3, 1}}) ==
          std::vector<std::string>{"interlock: firm and hard are side by side in no layer, no pixel changes sides"});
    const std::string named = "soft and firm";
    CHECK(told({{"soft", "firm", 3, 0, named}, {"soft of q", "firm", 3, 0, named}}, {}).empty());
    CHECK(told({{"soft", "hard", 3, 0, "soft and hard"}, {"soft of q", "hard", 3, 0, "soft and hard"}}, {}).size() ==
          1);
}

TEST_CASE("bleed compensation removes the lowest layers above an underside, and nothing else") {
    // A table: two legs and a plate from 200 to 500 um.
    const std::vector<Body> table{{"soft", box({-2000, -500, 0}, {-1000, 500, 500}), ""},
                                  {"soft", box({1000, -500, 0}, {2000, 500, 500}), ""},
                                  {"soft", box({-1000, -500, 200}, {1000, 500, 500}), ""}};
    Settings settings{small_raster, 50, {}};
    settings.compensation["soft"].bleed_um = 100;
    const auto slicer = Slicer::prepare(table, settings);
    REQUIRE(slicer.has_value());
    for (int k = 0; k < 10; ++k) {
        std::int64_t sum = 0;
        for (const MaterialImage& m : slicer->layer(k).images) sum += m.value_sum;
        CHECK(sum == 255 * (k < 6 ? 200 : 400));
    }
}

TEST_CASE("bleed compensation of a slope moves it sideways by as much as its height asks, with grey pixels too") {
    // A wedge that leans out by `lean` for each unit of height.
    for (const double lean : {0.3, 1.0, 2.5}) {
        Body wedge{"soft", box({-1000, -500, 0}, {1000, 500, 500}), ""};
        for (Vec3& p : wedge.surface_um.points)
            if (p.x > 0) p.x = 500 + lean * p.z;
        Settings settings{small_raster, 10, {}};
        const auto sum = [&](double bleed_um) {
            settings.compensation["soft"].bleed_um = bleed_um;
            const auto slicer = Slicer::prepare(std::vector{wedge}, settings);
            REQUIRE(slicer.has_value());
            std::int64_t light = 0;
            for (int k = 20; k < 40; ++k)
                for (const MaterialImage& m : slicer->layer(k).images) light += m.value_sum;
            return static_cast<double>(light);
        };
        const double bleed_um = 100, pixels = small_raster.pixel_um * small_raster.pixel_um;
        const double removed_um3 = (sum(0) - sum(bleed_um)) / 255 * pixels * 10;
        CHECK(removed_um3 == near(lean * bleed_um * 1000 * 200, {.relative = 0.02}));
    }
}
