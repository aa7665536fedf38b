#include "printing/slice/adaptive.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "base/core/near.hpp"
#include "printing/slice/layers.hpp"
#include "printing/slice/slicer.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

namespace {

/// A pyramid on a square, of height 3 mm: `n` is the vertical component of its faces' normals.
mesh::TriMesh pyramid(double half_base) {
    mesh::TriMesh m;
    const std::array<Vec3, 4> base{Vec3{-half_base, -half_base, 0}, Vec3{half_base, -half_base, 0},
                                   Vec3{half_base, half_base, 0}, Vec3{-half_base, half_base, 0}};
    const Vec3 top{0, 0, 3000};
    for (std::size_t i = 0; i < 4; ++i) add_triangle(m, base[i], base[(i + 1) % 4], top);
    add_triangle(m, base[0], base[2], base[1]);
    add_triangle(m, base[0], base[3], base[2]);
    return m;
}

}  // namespace

TEST_CASE("uniform layers and a list of layer tops are counted alike") {
    const Layers alike(50), own(std::vector<int>{50, 100, 150});
    for (int z = -100; z < 400; ++z) {
        CHECK(alike.middles_up_to(z, 1) == own.middles_up_to(z, 1));
        int count = 0;
        while ((count + 1) * 50 - 25 <= z) ++count;
        CHECK(alike.middles_up_to(z, 1) == count);
    }
    const Layers mixed(std::vector<int>{30, 130, 180});
    CHECK(mixed.middle2_um(1) == 160);
    CHECK(mixed.thickness_um(7) == 50);
    CHECK(mixed.middles_up_to(79, 1) == 1);
    CHECK(mixed.middles_up_to(80, 1) == 2);
    CHECK(mixed.middles_up_to(205, 1) == 4);
}

TEST_CASE("upright walls get thick layers; slanted ones get layers as thin as the step limit asks for") {
    const std::vector<Body> upright{{"soft", box({-1000, -1000, 0}, {1000, 1000, 1000}), ""}};
    CHECK(adaptive_tops(upright, {25, 100}).value().size() == 10);
    // 45 degrees: n = 1 / sqrt 2, so at most 25 sqrt 2 = 35.4, in steps of 5.
    const std::vector<Body> slanted{{"soft", pyramid(3000), ""}};
    const std::vector<int> tops = adaptive_tops(slanted, {25, 100}).value();
    CHECK(tops.front() == 35);
    CHECK(tops.size() == 86);
    CHECK(!adaptive_tops(slanted, {100, 25}).has_value());
}

TEST_CASE("layers end at horizontal faces, also just above or below where a thick layer would end") {
    const auto has = [](const std::vector<int>& tops, int z) {
        return std::find(tops.begin(), tops.end(), z) != tops.end();
    };
    for (const int shoulder : {20, 150, 190, 199, 201, 219, 290, 333, 400, 777, 979}) {
        CAPTURE(shoulder);
        const std::vector<Body> step{{"soft", box({-1000, -1000, 0}, {0, 1000, shoulder * 1.0}), ""},
                                     {"soft", box({0, -1000, 0}, {1000, 1000, 1000}), ""}};
        const std::vector<int> tops = adaptive_tops(step, {20, 200}).value();
        CHECK(has(tops, shoulder));
        CHECK(tops.back() == 1000);
        CHECK(tops.size() <= 7);
        int below = 0;
        for (const int top : tops) {
            CHECK(top - below >= 20);
            CHECK(top - below <= 200);
            below = top;
        }
    }
    // Too close to the platform, the top or each other: as near as layers of 20 um allow.
    const std::vector<Body> close{{"soft", box({-1000, -1000, 0}, {0, 1000, 290}), ""},
                                  {"soft", box({0, -1000, 7}, {500, 1000, 300}), ""},
                                  {"soft", box({500, -1000, 0}, {1000, 1000, 310}), ""}};
    const std::vector<int> tops = adaptive_tops(close, {20, 200}).value();
    CHECK(tops.front() == 20);
    CHECK(has(tops, 290));
    CHECK(tops.back() == 310);
}

TEST_CASE("layers of different heights have the volume of the pyramid") {
    // Upright below, slanted above: both limits are reached.
    std::vector<Body> bodies{{"soft", pyramid(2000), ""}, {"firm", box({-3000, 2100, 0}, {3000, 2300, 3000}), ""}};
    Settings settings{{160, 120, 50}, 100, {}};
    settings.tops_um = adaptive_tops(std::span(bodies).first(1), {20, 60}).value();
    const auto slicer = Slicer::prepare(bodies, settings);
    REQUIRE(slicer.has_value());
    double soft = 0, firm = 0;
    for (int k = 0; k < slicer->layer_count(); ++k) {
        for (const MaterialImage& m : slicer->layer(k).images)
            (m.material == 0 ? soft : firm) +=
                static_cast<double>(m.value_sum) / 255 * 0.0025 * slicer->layers().thickness_um(k) / 1000;
    }
    CHECK(soft == near(4 * 4 * 3.0 / 3, {.relative = 1e-3}));
    CHECK(firm == near(6 * 0.2 * 3, {.relative = 1e-12}));
}
