#include "printing/twin/cure.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"

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

TEST_CASE("an exposure cures the gap under the platform, in runs of equal pixels") {
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
    CHECK(cure.left_ml()[0] == near(1 - 0.0016e-3, {.relative = 1e-12}));
    CHECK(cure.faults().empty());
}

TEST_CASE("the layer that still grows can be seen without closing it") {
    const auto printer = small();
    Cure cure(printer);
    CHECK_FALSE(cure.open_layer());
    cure.expose(left, 0, 2, 50);
    CHECK(cure.layers().empty());
    REQUIRE(cure.open_layer());
    CHECK(cure.open_layer()->top_um == 50);
    CHECK(cure.open_layer()->vats.size() == 1);
    cure.expose(left, 0, 1, 50);  // continues it
    CHECK(cure.open_lights() == 1);
    cure.expose(right, 1, 2, 50);
    CHECK(cure.open_lights() == 2);
    CHECK(cure.open_layer()->vats[1].runs == runs_of(right));
    cure.expose(left, 0, 2, 100);
    REQUIRE(cure.layers().size() == 1);
    CHECK(cure.layers()[0].vats.size() == 2);
    CHECK(cure.open_lights() == 1);
    cure.finish();
    CHECK(cure.layers().size() == 2);
    CHECK(cure.open_lights() == 0);
    CHECK_FALSE(cure.open_layer());
}

TEST_CASE("below the critical share of the exposure nothing cures; at it a layer does") {
    const auto printer = small();
    for (const double seconds : {1.59, 1.6}) {
        Cure cure(printer);
        cure.expose(left, 0, seconds, 50);
        cure.finish();
        CHECK(cure.faults().size() == (seconds < 1.6 ? 1 : 0));
        CHECK(cure.layers().size() == (seconds < 1.6 ? 0 : 1));
    }
}

TEST_CASE("an exposure given in parts adds up, and uses its resin once") {
    const auto printer = small();
    for (const double first : {0.3, 1.7}) {
        Cure cure(printer);
        cure.expose(left, 0, first, 50);
        cure.expose(left, 0, 2 - first, 50);
        cure.finish();
        CHECK(cure.faults().empty());
        REQUIRE(cure.layers().size() == 1);
        REQUIRE(cure.layers()[0].vats[0].lit.size() == 1);
        CHECK(cure.layers()[0].vats[0].lit[0].seconds == near(2, {.relative = 1e-12}));
        CHECK(cure.layers()[0].vats[0].lit[0].pieces == 2);
        CHECK(cure.pixels_lit_twice() == 0);
        CHECK(cure.left_ml()[0] == near(1 - 0.0016e-3, {.relative = 1e-12}));
    }
    Cure elsewhere(printer);  // another image, vat or height does not continue it
    elsewhere.expose(left, 0, 0.3, 50);
    elsewhere.expose(left, 1, 1.7, 50);
    elsewhere.expose(left, 0, 1.5, 50);
    elsewhere.finish();
    CHECK(elsewhere.faults().size() == 2);
}

TEST_CASE("a second exposure of the same pixels is counted") {
    const auto printer = small();
    Cure cure(printer);
    cure.expose(left, 0, 2, 50);
    cure.expose(left, 1, 2, 50);
    cure.finish();
    CHECK(cure.pixels_lit_twice() == 3);
}

TEST_CASE("the layer thickness is the gap; in too deep a gap the layer and all later ones are lost") {
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

TEST_CASE("resin that is used up does not cure") {
    auto printer = small();
    printer.vats[0].fill_ml = 2e-6;  // a layer of the left image takes 1.6e-6
    Cure cure(printer);
    cure.expose(left, 0, 2, 50);
    CHECK(cure.faults().empty());
    cure.expose(left, 0, 2, 100);
    cure.finish();
    CHECK(cure.faults().size() == 1);
    CHECK(cure.layers().size() == 1);
}

TEST_CASE("the working curve follows from cure depth and critical share, or from given constants") {
    auto printer = small();
    const WorkingCurve derived = working_curve(printer, printer.resins[0]);
    CHECK(derived.depth_um(2) == near(120, {.relative = 1e-12}));  // no irradiance in the file: 1 W/m^2
    CHECK(derived.depth_um(1.6) == near(50, {.relative = 1e-12}));
    CHECK(derived.depth_um(0) == 0);
    printer.resins[0].penetration_um = 100;
    printer.resins[0].critical_J_m2 = 50;
    const WorkingCurve given = working_curve(printer, printer.resins[0]);
    CHECK(given.depth_um(50) == 0);
    CHECK(given.depth_um(50 * 2.718281828459045) == near(100, {.relative = 1e-12}));
}

TEST_CASE("light through an overhang cures resin below it, more with every layer") {
    auto printer = small();
    printer.projector.irradiance_W_m2 = 100;
    printer.resins[0].penetration_um = 100;
    printer.resins[0].critical_J_m2 = 100;
    Cure cure(printer);
    // Two layers on the left; then one all over: a ceiling of 4 pixels of 0.01 mm^2, 100 um above the platform.
    const job::Image all{4, 2, {255, 255, 255, 255, 255, 255, 255, 255}};
    cure.expose(left, 0, 2, 50);
    cure.expose(left, 0, 2, 100);
    CHECK(cure.overcure_mm3()[0] == 0);
    cure.expose(all, 0, 2, 150);
    // 200 J/m^2 less 50 um: e^-0.5; 100 ln(200 e^-0.5 / 100) = 19.3 um.
    CHECK(cure.deepest_overcure_um() == near(100 * (std::log(2.0) - 0.5), {.relative = 1e-5}));
    // Four pixels of the left image are lit there: the four dark ones are free below.
    CHECK(cure.overcure_mm3()[0] == near(4 * 0.01 * 0.1 * (std::log(2.0) - 0.5), {.relative = 1e-5}));
    cure.expose(all, 0, 2, 200);
    CHECK(cure.deepest_overcure_um() == near(100 * (std::log(2 * (1 + std::exp(-0.5))) - 0.5), {.relative = 1e-6}));
    for (int z = 250; z <= 1000; z += 50) cure.expose(all, 0, 2, z);
    CHECK(cure.deepest_overcure_um() <= 100);  // the platform is there
    CHECK(cure.faults().empty());
}
