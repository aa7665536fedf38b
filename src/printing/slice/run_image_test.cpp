#include "printing/slice/run_image.hpp"

#include <doctest/doctest.h>

using namespace pliant::slice;

namespace {

/// Rows of blanks, stripes and noise.
Image mixture(int width, int height) {
    Image image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height)};
    std::uint32_t state = 3;
    for (int row = 0; row < height; ++row) {
        for (int column = 0; column < width; ++column) {
            state = state * 1664525 + 1013904223;
            const int value = row % 4 == 0 ? 0 : row % 4 == 1 ? 255 * (column / 9 % 2) : static_cast<int>(state >> 30);
            image.pixels[static_cast<std::size_t>(row) * width + column] = static_cast<std::uint8_t>(value);
        }
    }
    return image;
}

}  // namespace

TEST_CASE("an image converted to runs and back is the same, and both give the same answers") {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {65, 11}, {64, 4}}) {
        const Image image = mixture(width, height);
        const RunImage runs = RunImage::from_image(image);
        CHECK(runs.to_image() == image);
        std::int64_t sum = 0;
        for (const auto p : image.pixels) sum += p;
        CHECK(runs.value_sum() == sum);
        bool same = true;
        for (int row = 0; row < height; ++row) {
            for (int column = 0; column < width; ++column) same = same && runs.at(row, column) == image.at(row, column);
        }
        CHECK(same);
    }
}

TEST_CASE("neighbouring pixels of one value form one run, black pixels none") {
    RunImage image(100, 50);
    CHECK(image.blank());
    CHECK(image.end_row() == 0);
    image.append(7, 3, 5, 255);
    image.append(7, 5, 9, 255);
    image.append(7, 9, 10, 128);
    image.append(7, 10, 12, 0);
    image.append(7, 12, 13, 128);
    image.append(9, 0, 100, 1);
    CHECK(image.first_row() == 7);
    CHECK(image.end_row() == 10);
    REQUIRE(image.row(7).size() == 3);
    CHECK(image.row(7)[0] == Run{3, 9, 255});
    CHECK(image.row(8).empty());
    CHECK(image.row(9).size() == 1);
    CHECK(image.row(50).empty());
    CHECK(int{image.at(7, 9)} == 128);
    CHECK(int{image.at(7, 10)} == 0);
    CHECK(int{image.at(-1, 200)} == 0);
}
