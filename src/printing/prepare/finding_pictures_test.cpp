#include "printing/prepare/finding_pictures.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "printing/job/manifest.hpp"
#include "printing/job/png.hpp"
#include "printing/slice/slicer.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::job;
using slice::test::box;

namespace {

const slice::Raster raster{400, 300, 100};

}  // namespace

TEST_CASE("an island is listed, and drawn white in its picture") {
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
    CHECK(findings[0].area_mm2 == near(0.24, {.relative = 1e-12}));
    CHECK(findings[0].row == 148);
    CHECK(findings[0].column == 200);

    const EncodedImage png = picture(findings[0], slicer->layer(5), slicer->layer(4), raster);
    CHECK(png.width_px == 240);
    CHECK(png.height_px == 240);
    const auto image = decode_png(png.png, {240, 240}, "picture");
    REQUIRE(image.has_value());
    // The finding's pixel is in the middle; the legs are 3.5 mm to both sides of the part's centre.
    CHECK(image->at(120, 120) == 255);
    CHECK(image->at(120, 125) == 255);
    CHECK(image->at(120, 126) == 0);
    CHECK(image->at(120, 120 - 35) == 150);
    CHECK(std::count(image->pixels.begin(), image->pixels.end(), 255) == 24);
}

TEST_CASE("islands of raster size are one finding, after the important ones") {
    slice::Findings found;
    const auto group = [](slice::Severity severity, int islands, std::int64_t pixels, int layer) {
        slice::IslandGroup g;
        g.islands = islands;
        g.first_layer = layer;
        g.last_layer = layer + 1;
        g.held_layer = layer + 2;
        g.largest = {layer, 10, 20, pixels};
        g.most_pixels = g.voxels = pixels;
        g.severity = severity;
        return g;
    };
    for (int i = 0; i < 1453; ++i) found.groups.push_back(group(slice::Severity::low, 1, 1 + i % 3, i));
    found.groups.push_back(group(slice::Severity::medium, 2, 900, 40));
    for (int i = 0; i < 30; ++i) found.groups.push_back(group(slice::Severity::high, 3, 20 + i, 50));
    const std::vector<Finding> findings = listed(found, {}, raster);
    REQUIRE(findings.size() == most_findings + 1);
    CHECK(findings[0].severity == "high");
    CHECK(findings[0].count == 3);
    CHECK(findings[0].area_mm2 == near(0.49, {.relative = 1e-12}));
    CHECK(findings[0].last_layer == 51);
    CHECK(findings[most_findings - 1].severity == "high");
    const Finding& grain = findings.back();
    CHECK(grain.severity == "low");
    CHECK(grain.count == 1453);
    CHECK(grain.area_mm2 == near(0.03, {.relative = 1e-12}));

    Manifest m;
    m.width_px = m.height_px = 100;
    m.pixel_um = 100;
    for (int k = 0; k < 2000; ++k) m.layers.push_back({50 * (k + 1), 50, {}});
    m.findings = findings;
    const auto read = manifest_from_json(to_json(m), "manifest");
    REQUIRE_MESSAGE(read.has_value(), (read ? "" : read.error().message));
    CHECK(read->findings.back().count == 1453);
    CHECK(read->findings[0].severity == "high");
}
