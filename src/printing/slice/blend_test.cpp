#include "printing/slice/blend.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "printing/slice/slicer.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

namespace {

Body blended(const mesh::TriMesh& mesh, const Blend& blend) {
    Body body{"soft", mesh, "bar"};
    body.blend = blend;
    return body;
}

struct Shares {
    double first = 0, second = 0;  ///< light, in whole pixels
};

Shares shares_of(const SlicedLayer& layer) {
    Shares s;
    for (const MaterialImage& m : layer.images)
        (m.material == 0 ? s.first : s.second) += static_cast<double>(m.value_sum) / 255;
    return s;
}

}  // namespace

TEST_CASE("a blend lights the integral of its share, in every layer, in whole pixels, none twice") {
    // 6 x 4 mm, 60 x 40 pixels; the share rises from 0 to 1 along x, so half of it is of the second material.
    const std::vector<Body> bodies{
        blended(box({-3000, -2000, 0}, {3000, 2000, 500}), {"firm", {-3000, 0, 0}, {3000, 0, 0}})};
    const auto slicer = Slicer::prepare(bodies, {small_raster, 50, {}});
    REQUIRE(slicer.has_value());
    CHECK(slicer->materials() == std::vector<std::string>{"soft", "firm"});
    std::vector<double> of_column(60, 0);
    for (int k = 0; k < 10; ++k) {
        const SlicedLayer layer = slicer->layer(k);
        const Shares s = shares_of(layer);
        CHECK(std::fabs(s.second - 1200) <= 1);
        CHECK(s.first + s.second == near(2400, {.relative = 1e-12}));
        REQUIRE(layer.images.size() == 2);
        for (int row = 0; row < 48; ++row) {
            for (int column = 0; column < 64; ++column) {
                const int a = layer.images[0].image.at(row, column), b = layer.images[1].image.at(row, column);
                CHECK((a == 0 || b == 0));
                if (b > 0) of_column[static_cast<std::size_t>(column - 2)] += 1;
            }
        }
    }
    // Also along the line: six columns of 400 pixels in ten layers have their fraction to a few percent.
    for (int i = 0; i < 10; ++i) {
        double sum = 0;
        for (int c = 0; c < 6; ++c) sum += of_column[static_cast<std::size_t>(6 * i + c)];
        CHECK(sum / 2400 == near((i + 0.5) / 10, {.absolute = 0.03}));
    }
}

TEST_CASE("blends with grey edges, cells of several pixels, a vertical ramp and uneven shares") {
    const auto pillar = prism(regular_polygon(90, 2000), 0, 1000);
    const Blend up{"firm", {0, 0, 0}, {0, 0, 1000}, {0.25, 0.75, 0.5}, 3};
    const auto slicer = Slicer::prepare(std::vector<Body>{blended(pillar, up)}, {small_raster, 50, {}});
    REQUIRE(slicer.has_value());
    for (int k = 0; k < slicer->layer_count(); ++k) {
        const double z = (k + 0.5) / 20;
        const double share = z < 0.5 ? 0.25 + z : 0.75 - (z - 0.5) / 2;
        const Shares s = shares_of(slicer->layer(k));
        CHECK(std::fabs(s.second - share * (s.first + s.second)) <= 9);
    }
}

TEST_CASE("equal layers of a blend have different patterns, the same on every run") {
    const std::vector<Body> bodies{
        blended(box({-3000, -2000, 0}, {3000, 2000, 500}), {"firm", {0, 0, 0}, {0, 0, 1e6}, {0.5, 0.5}})};
    const auto slicer = Slicer::prepare(bodies, {small_raster, 50, {}});
    REQUIRE(slicer.has_value());
    CHECK(slicer->layer(2).images[0].image == slicer->layer(2).images[0].image);
    CHECK(!(slicer->layer(2).images[0].image == slicer->layer(3).images[0].image));
}

TEST_CASE("a blend may touch another body of one of its materials") {
    std::vector<Body> bodies{blended(box({-3000, -2000, 0}, {0, 2000, 100}), {"firm", {-3000, 0, 0}, {0, 0, 0}}),
                             {"firm", box({0, -2000, 0}, {3000, 2000, 100}), "block"}};
    const auto slicer = Slicer::prepare(bodies, {small_raster, 50, {}});
    REQUIRE(slicer.has_value());
    const Shares s = shares_of(slicer->layer(0));
    CHECK(std::fabs(s.second - 1800) <= 1);
    bodies[0].blend->shares = {1.5, 0};
    const auto refused = Slicer::prepare(bodies, {small_raster, 50, {}});
    REQUIRE(!refused.has_value());
    CHECK(refused.error().message == "body 'bar' (soft): share 1.5 of its blend: must be 0 to 1");
}
