#include "job/finding_pictures.hpp"

#include <doctest/doctest.h>

#include "job/png.hpp"
#include "slice/slicer.hpp"
#include "slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::job;
using slice::test::box;

namespace {

const slice::Raster raster{400, 300, 100};

}  // namespace

TEST_CASE("an island is listed, and white in its picture") {
    // A gate with something that hangs between its legs.
    const std::vector<slice::Body> bodies{{"soft", box({-4000, -500, 0}, {-3000, 500, 900}), ""},
                                          {"soft", box({3000, -500, 0}, {4000, 500, 900}), ""},
                                          {"soft", box({-4000, -500, 900}, {4000, 500, 1000}), ""},
                                          {"soft", box({0, -200, 500}, {600, 200, 900}), ""}};
    const auto slicer = slice::Slicer::prepare(bodies, {raster, 100, {}});
    REQUIRE(slicer.has_value());
    slice::Inspector inspector(slicer->layers());
    for (int k = 0; k < slicer->layer_count(); ++k) inspector.add(slice::shape_of(slicer->layer(k), raster.width_px));
    const std::vector<Finding> findings = listed(inspector.finish(), {}, raster);
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].kind == "island");
    CHECK(findings[0].first_layer == 5);
    CHECK(findings[0].area_mm2 == doctest::Approx(0.24));
    CHECK(findings[0].row == 148);
    CHECK(findings[0].column == 200);

    const EncodedImage png = picture(findings[0], slicer->layer(5), slicer->layer(4), raster);
    CHECK(png.width_px == 240);
    CHECK(png.height_px == 240);
    const auto image = decode_png(png.png, {240, 240}, "picture");
    REQUIRE(image.has_value());
    // The finding's pixel lies in the middle; the legs 3.5 mm to both sides of the part's middle.
    CHECK(image->at(120, 120) == 255);
    CHECK(image->at(120, 125) == 255);
    CHECK(image->at(120, 126) == 0);
    CHECK(image->at(120, 120 - 35) == 150);
    CHECK(std::count(image->pixels.begin(), image->pixels.end(), 255) == 24);
}
