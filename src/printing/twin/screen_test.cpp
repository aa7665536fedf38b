#include "printing/twin/screen.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace pliant;
using namespace pliant::twin;

namespace {

machine::Projector grey_projector(std::vector<double> grey) {
    machine::Projector p;
    p.width_px = 256;
    p.height_px = 1;
    p.grey = std::move(grey);
    return p;
}

/// Pixel x holds value x.
Runs ramp() {
    Runs runs;
    for (int x = 1; x < 256; ++x) runs.push_back({0, x, x + 1, static_cast<std::uint16_t>(x)});
    return runs;
}

int value_at(const Runs& runs, int column) {
    for (const Run& r : runs) {
        if (r.begin <= column && column < r.end) return r.value;
    }
    return 0;
}

}  // namespace

TEST_CASE("without grey curve and mask an image is its coverage") {
    const Screen::Picture picture = Screen(grey_projector({}), std::nullopt).coverage(ramp());
    CHECK(picture.runs == ramp());
    CHECK(picture.overlit_px == 0);
}

TEST_CASE("the grey curve is inverted: the grey value for a coverage gives that coverage") {
    const Screen screen(grey_projector({0, 0.5, 0.8, 1}), std::nullopt);
    // The light of coverages 1/3 and 2/3 in the printer file, and of the midpoint between 2/3 and 1.
    const Runs shown = {{0, 0, 1, 128}, {0, 1, 2, 204}, {0, 2, 3, 230}, {0, 3, 4, 255}};
    const Runs runs = screen.coverage(shown).runs;
    CHECK(std::abs(value_at(runs, 0) - 85) <= 1);
    CHECK(std::abs(value_at(runs, 1) - 170) <= 1);
    CHECK(std::abs(value_at(runs, 2) - 213) <= 1);
    CHECK(value_at(runs, 3) == 255);
}

TEST_CASE("the mask is inverted, and pixels brighter than it allows are counted") {
    job::Image mask{256, 1, std::vector<std::uint8_t>(256, 200)};
    const Screen screen(grey_projector({}), mask);
    const Screen::Picture picture = screen.coverage(ramp());
    CHECK(value_at(picture.runs, 100) == 128);  // 100 / 200 of the light of a whole pixel
    CHECK(value_at(picture.runs, 200) == 255);
    CHECK(value_at(picture.runs, 255) == 255);
    CHECK(picture.overlit_px == 55);
}
