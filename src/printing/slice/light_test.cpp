#include "printing/slice/light.hpp"

#include <doctest/doctest.h>

using namespace pliant::slice;

TEST_CASE("grey values are interpolated linearly between the calibrated points") {
    const std::array<double, 3> light{0, 0.8, 1};
    const auto values = grey_values(light);
    CHECK(int{values[0]} == 0);
    CHECK(int{values[51]} == 82);    // a fifth: 0.4 of the way to 0.8 = 0.32 of 255
    CHECK(int{values[128]} == 204);  // just over the middle
    CHECK(int{values[255]} == 255);
    const std::array<double, 2> straight{0, 1};
    for (int v = 0; v < 256; ++v) CHECK(int{grey_values(straight)[static_cast<std::size_t>(v)]} == v);
}

TEST_CASE("the mask scales every lit pixel") {
    RunImage image(4, 2);
    image.append(1, 0, 3, 200);
    LightCorrection correction;
    correction.mask = Image{4, 2, {9, 9, 9, 9, 255, 128, 0, 255}};
    const RunImage masked = corrected(image, correction);
    CHECK(int{masked.at(1, 0)} == 200);
    CHECK(int{masked.at(1, 1)} == 100);
    CHECK(int{masked.at(1, 2)} == 0);
    CHECK(int{masked.at(1, 3)} == 0);
    correction.grey = grey_values(std::array<double, 2>{0, 0.5});
    CHECK(int{corrected(image, correction).at(1, 0)} == 100);
}

TEST_CASE("what a black mask takes away is added up, and nothing else") {
    RunImage image(4, 2);
    image.append(0, 1, 3, 255);
    image.append(1, 0, 3, 200);
    LightCorrection correction;
    CHECK(darkened_sum(image, correction) == 0);
    correction.mask = Image{4, 2, {0, 0, 1, 0, 255, 128, 0, 0}};
    CHECK(darkened_sum(image, correction) == 255 + 200);
}
