#include "twin/cure.hpp"

#include <doctest/doctest.h>

using namespace pliant;
using namespace pliant::twin;

namespace {

/// Two vats of 1 ml; resins need 2 s (critical 1.6 s) and cure 120 um; pixels of 0.1 mm, 4 x 2 of them.
machine::Printer small() {
    machine::Printer p;
    p.tower.slots = 2;
    p.vats = {{1, "soft", 1}, {2, "rigid", 1}};
    p.resins = {{"soft", 2, 2, 0, 120, 0.8, 0, 0}, {"rigid", 2, 2, 0, 120, 0.8, 0, 0}};
    p.projector.width_px = 4;
    p.projector.height_px = 2;
    p.projector.pixel_um = 100;
    return p;
}

const job::Image left{4, 2, {255, 255, 0, 0, 255, 51, 0, 0}};
const job::Image right{4, 2, {0, 0, 255, 255, 0, 204, 255, 255}};

}  // namespace

TEST_CASE("light cures the gap under the platform, in runs of equal pixels") {
    const auto printer = small();
    Cure cure(printer);
    cure.expose(left, 0, 2, 50);
    cure.expose(right, 1, 2, 50);
    cure.finish();
    REQUIRE(cure.layers().size() == 1);
    const CuredLayer& layer = cure.layers()[0];
    CHECK(layer.thickness_um == 50);
    REQUIRE(layer.vats.size() == 2);
    REQUIRE(layer.vats[0].runs.size() == 3);
    CHECK(layer.vats[0].runs[0].end == 2);
    CHECK(layer.vats[0].runs[2].value == 51);
    CHECK(cure.pixels_lit_twice() == 0);
    // 3.2 pixels of 0.01 mm^2 and 50 um: 0.0016 mm^3.
    CHECK(cure.left_ml()[0] == doctest::Approx(1 - 0.0016e-3));
    CHECK(cure.faults().empty());
}

TEST_CASE("too short a light leaves nothing, the critical share is enough") {
    const auto printer = small();
    Cure cure(printer);
    cure.expose(left, 0, 1.59, 50);
    cure.expose(left, 0, 1.6, 50);
    cure.finish();
    REQUIRE(cure.faults().size() == 1);
    CHECK(cure.layers().size() == 1);
    CHECK(cure.pixels_lit_twice() == 0);
}

TEST_CASE("a second light on the same pixels is counted") {
    const auto printer = small();
    Cure cure(printer);
    cure.expose(left, 0, 2, 50);
    cure.expose(left, 1, 2, 50);
    cure.finish();
    CHECK(cure.pixels_lit_twice() == 3);
}

TEST_CASE("thickness is the gap; a gap that is too deep is lost with all that follows") {
    const auto printer = small();
    Cure cure(printer);
    cure.expose(left, 0, 2, 50);
    cure.expose(left, 0, 2, 160);
    cure.expose(left, 0, 2, 281);
    cure.finish();
    REQUIRE(cure.layers().size() == 2);
    CHECK(cure.layers()[1].thickness_um == 110);
    CHECK(cure.faults().size() == 1);
}

TEST_CASE("a vat runs dry once") {
    auto printer = small();
    printer.vats[0].fill_ml = 1e-6;
    Cure cure(printer);
    cure.expose(left, 0, 2, 50);
    cure.expose(left, 0, 2, 100);
    CHECK(cure.faults().size() == 1);
}
