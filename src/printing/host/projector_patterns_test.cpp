#include "printing/host/projector_patterns.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::host;

namespace {

const PatternOptions small{320, 200, 100, 1, 5, 3};

long count(const job::Image& image, std::uint8_t value) {
    return std::count(image.pixels.begin(), image.pixels.end(), value);
}

}  // namespace

TEST_CASE("every pattern has the panel's size, whatever it is") {
    for (const std::string& name : pattern_names()) {
        for (const auto& [width, height] : {std::pair{16, 16}, {320, 200}, {1920, 1080}, {17, 900}}) {
            PatternOptions options{width, height, 50, 3, 5, 3};
            const auto image = test_pattern(name, options);
            REQUIRE_MESSAGE(image, name);
            CHECK(image->width_px == width);
            CHECK(image->pixels.size() == static_cast<std::size_t>(width * height));
        }
    }
    CHECK(test_pattern("gird", small).error().message.find("\"grid\"") != std::string::npos);
    CHECK_FALSE(test_pattern("white", {8, 200, 0, 1, 5, 3}));
}

TEST_CASE("white, black, checkerboard and ramp have the right pixel values") {
    CHECK(count(*test_pattern("white", small), 255) == 320 * 200);
    CHECK(count(*test_pattern("black", small), 0) == 320 * 200);
    PatternOptions squares = small;
    squares.square_px = 20;
    const auto board = *test_pattern("checkerboard", squares);
    CHECK(board.at(0, 19) == 255);
    CHECK(board.at(0, 20) == 0);
    CHECK(board.at(20, 20) == 255);
    CHECK(count(board, 255) == 320 * 200 / 2);
    const auto ramp = *test_pattern("ramp", {512, 64, 0, 1, 5, 3});
    for (int value = 0; value < 256; ++value) CHECK(ramp.at(0, 2 * value) == value);
    CHECK(ramp.at(63, 0) == 0);
    CHECK(ramp.at(63, 511) == 255);
}

TEST_CASE("the border's rectangle has the stated size, and the rulers' marks are millimetres") {
    const auto image = *test_pattern("border", small);
    const MeasuredSpan span = measured_span(320, 200);
    CHECK(span.x_px == 288);
    CHECK(span.y_px == 180);
    // A row that crosses only the frame, the rectangle and the centre line.
    std::vector<int> lit;
    for (int x = 0; x < 320; ++x) {
        if (image.at(45, x) == 255) lit.push_back(x);
    }
    CHECK(lit == std::vector<int>{0, 16, 160, 16 + 288, 319});
    // 100 um a pixel: 10 pixels a millimetre, a long mark every ten.
    CHECK(image.at(102, 170) == 255);
    CHECK(image.at(103, 170) == 0);
    CHECK(image.at(108, 260) == 255);
    for (int x = 0; x < 320; ++x) REQUIRE(image.at(0, x) == 255);
}

TEST_CASE("the pixel size follows from measured distances") {
    const auto size = pixel_size(320, 200, 28.8, 18.0);
    REQUIRE(size);
    CHECK(size->pixel_um == near(100, {.relative = 1e-12}));
    CHECK(size->off_percent == near(0, {.absolute = 1e-9}));
    const auto skew = pixel_size(320, 200, 28.8 * 1.02, 18.0);
    CHECK(skew->pixel_um == near(101, {.relative = 1e-12}));
    CHECK(skew->off_percent == near(2, {.relative = 1e-12}));
    CHECK_FALSE(pixel_size(320, 200, 0, 18));
    CHECK(
        pixel_size(320, 200, 18, 28.8).error().message ==
        "measured 18 x 28.8 mm: the pixels would be 62.5 um wide and 160.0 um high; X is along the 320 px, Y along the "
        "200 px");
    CHECK_FALSE(pixel_size(320, 200, std::nan(""), 18));
}

TEST_CASE("a mask makes uneven light uniform") {
    const auto table = parse_light_table("# mW/cm2\n4.0, 5.0, 4.0\n 4.5; 5.5; 4.5\n4.0\t5.0\t4.0\n", "light.txt");
    REQUIRE_MESSAGE(table, (table ? "" : table.error().message));
    CHECK(table->columns == 3);
    CHECK(table->rows == 3);
    const LightMask mask = light_mask(*table, 300, 150, 1);
    CHECK(mask.least == near(4.0 / 5.5, {.relative = 1e-12}));
    CHECK(mask.mask.at(0, 0) == 255);
    // The light of a place times its mask equals the darkest reading.
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            const int y = static_cast<int>(point_px(row, 3, 150));
            const int x = static_cast<int>(point_px(column, 3, 300));
            const double light = table->readings[static_cast<std::size_t>(3 * row + column)];
            CHECK(light * mask.mask.at(y, x) / 255.0 == near(4.0, {.relative = 0.01}));
        }
    }
    const LightMask curved = light_mask(*table, 300, 150, 2.2);
    CHECK(5.5 * std::pow(curved.mask.at(75, 150) / 255.0, 2.2) == near(4.0, {.relative = 0.01}));
}

TEST_CASE("an invalid table is refused, by line") {
    const auto said = [](std::string_view text) {
        const auto table = parse_light_table(text, "light.txt");
        return table ? std::string("read") : table.error().message;
    };
    CHECK(said("1 2\n3\n").find("light.txt: line 2") == 0);
    CHECK(said("1 2\n3 0\n").find("light.txt: line 2") == 0);
    CHECK(said("1 2\n3 x\n").find("light.txt: line 2") == 0);
    CHECK(said("4,1 4,8\n4,4 5,1\n") == "light.txt: line 1: numbers have a decimal point, as in 4.1, not a comma");
    CHECK(said("4,1;4,8\n4,4;5,1\n").find("light.txt: line 1: numbers have") == 0);
    CHECK(said("  4,5,4 \n4, 5, 4\n") == "read");
    CHECK(said("1 nan\n").find("light.txt: line 1") == 0);
    CHECK(said("1 2\n").find("1 rows of 2") != std::string::npos);
    CHECK(said("").find("0 rows") != std::string::npos);
}

TEST_CASE("squares of too many pixels are refused with the limit") {
    PatternOptions options;
    options.width_px = options.height_px = 64;
    options.square_px = 100000;
    CHECK(test_pattern("checkerboard", options).error().message == "squares of 100000 px: must be 1 to 32768");
}
