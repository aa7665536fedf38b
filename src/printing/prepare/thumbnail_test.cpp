#include "printing/prepare/thumbnail.hpp"

#include <doctest/doctest.h>

#include "printing/slice/slicer.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::job;
using slice::test::box;

TEST_CASE("a thumbnail shows the part from the front, upright and in proportion") {
    // 4 mm wide and 2 mm high; the left half reaches only to 1 mm; the right one is as deep as the part, of another
    // material.
    const std::vector<slice::Body> bodies{{"soft", box({-2000, -500, 0}, {0, 500, 1000}), ""},
                                          {"firm", box({0, -1000, 0}, {2000, 1000, 2000}), ""}};
    const auto slicer = slice::Slicer::prepare(bodies, {{64, 48, 100}, 50, {}});
    REQUIRE(slicer.has_value());
    Thumbnail thumbnail(64);
    for (int k = 0; k < slicer->layer_count(); ++k) thumbnail.add(thumbnail.row(slicer->layer(k)));
    const slice::Image image = thumbnail.picture(slicer->layers(), 100);
    REQUIRE(image.width_px == 400);
    // 380 pixels for 4 mm, so 190 for 2 mm, in the middle.
    CHECK(image.at(200, 5) == 0);
    CHECK(image.at(100, 300) == 0);
    CHECK(image.at(110, 300) == 150);
    CHECK(image.at(110, 100) == 0);
    CHECK(image.at(190, 100) == 0);
    CHECK(image.at(210, 100) == 191);  // half as deep as the deepest
    CHECK(image.at(290, 100) == 191);
    CHECK(image.at(300, 100) == 0);
}
