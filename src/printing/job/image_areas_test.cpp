#include "printing/job/image_areas.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::job;

namespace {

slice::Image image(int width, int height, const std::vector<std::string>& rows) {
    slice::Image result{width, height, {}};
    for (const std::string& row : rows) {
        for (const char c : row) result.pixels.push_back(c == '#' ? 255 : c == '+' ? 51 : 0);
    }
    return result;
}

}  // namespace

TEST_CASE("components join along sides of pixels, and a grey pixel counts its share") {
    const ImageAreas a = areas_of(image(6, 4,
                                        {".##..+",  //
                                         ".#..#.",  //
                                         ".....+",  //
                                         "......"}));
    // Three whole pixels, one, and two faint ones that touch others only at corners.
    CHECK(a.count == 4);
    CHECK(a.total_px == near(4.4, {.relative = 1e-12}));
    CHECK(a.largest_px == near(3, {.relative = 1e-12}));
    CHECK(a.smallest_px == near(0.2, {.relative = 1e-12}));
    CHECK(a.min_x == 1);
    CHECK(a.max_x == 5);
    CHECK(a.min_y == 0);
    CHECK(a.max_y == 2);
}

TEST_CASE("a ring is one component, and a grey rim belongs to its component") {
    const ImageAreas a = areas_of(image(5, 4,
                                        {"+++++",  //
                                         "+#.#+",  //
                                         "+###+",  //
                                         "+++++"}));
    CHECK(a.count == 1);
    CHECK(a.total_px == near(5 + 14 * 0.2, {.relative = 1e-12}));
    CHECK(a.largest_px == a.total_px);
    CHECK(a.smallest_px == a.total_px);
}

TEST_CASE("a black image has no components") {
    const ImageAreas a = areas_of(image(3, 1, {"..."}));
    CHECK(a.count == 0);
    CHECK(a.total_px == 0);
    CHECK(a.max_x == 0);
}
