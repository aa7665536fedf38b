#include "presentation/draw/colour.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"

using namespace pliant::report;
using pliant::near;

TEST_CASE("sRGB and linear light are inverse, with the values of IEC 61966-2-1") {
    const Colour linear = to_linear({0.5, 0.04, 1});
    CHECK(linear.r == near(0.2140411, {.relative = 1e-5}));
    CHECK(linear.g == near(0.04 / 12.92, {.relative = 1e-12}));
    CHECK(linear.b == near(1, {.relative = 1e-12}));
    CHECK(to_srgb(linear).r == near(0.5, {.relative = 1e-12}));
    const Colour clamped = to_srgb({2, -1, 0});
    CHECK(clamped.r == near(1, {.relative = 1e-12}));
    CHECK(clamped.g == 0);
}

TEST_CASE("hexadecimal colours round to the nearest byte") {
    CHECK(hex({1, 0.5, 0}) == "#ff8000");
    CHECK(hex({0.002, 0.0019, -3}) == "#010000");
}

TEST_CASE("the field colour map has linear lightness and lies inside sRGB") {
    for (int i = 0; i <= 20; ++i) {
        const double t = i / 20.0;
        CHECK(lightness(field_colour(t)) == near(0.27 + 0.65 * t, {.relative = 0.01}));
    }
    CHECK(field_colour(-5) == field_colour(0));
    CHECK(field_colour(7) == field_colour(1));
    CHECK(field_colour(std::nan("")) == field_colour(0));
}

TEST_CASE("the palette repeats after eight") {
    CHECK(palette(0) == palette(8));
    CHECK_FALSE(palette(0) == palette(1));
}
