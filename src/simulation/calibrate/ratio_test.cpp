#include "simulation/calibrate/ratio.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::calibrate;

namespace {

RatioOptions coarse() {
    RatioOptions options;
    options.cells = {12, 2, 2};
    return options;
}

}  // namespace

TEST_CASE("equal materials: the interface of a long bar moves half as far as its end") {
    RatioOptions options = coarse();
    const auto u = reference_displacement_mm(options, 1);
    REQUIRE(u);
    CHECK(*u == near(15, {.relative = 1e-4}));
    const auto R = match_shape_parameter(options, 15, 2);
    REQUIRE(R);
    CHECK(*R == near(1, {.relative = 1e-6}));
}

TEST_CASE("the matched shape parameter gives the displacement that was asked for") {
    const RatioOptions options = coarse();
    const auto R = match_shape_parameter(options, 6, 3);
    REQUIRE(R);
    const auto u = blend_displacement_mm(options, *R);
    REQUIRE(u);
    CHECK(*u == near(6, {.relative = 2e-5}));
    CHECK_FALSE(match_shape_parameter(options, 16, 3));  // more than half: the soft part would have to be stiffer
}

TEST_CASE("a long bar at small strain and Poisson ratio 0 follows the small-strain map") {
    // The uniaxial stiffness of the blend is 3 w a / (2 + a): w and 3 w a / (2 + a) for the two halves, so the ratio of
    // their stretches is known.
    RatioOptions options = coarse();
    options.strain = 1e-3;
    const double R = 4;
    const auto u = blend_displacement_mm(options, R);
    REQUIRE(u);
    const double soft = 3 / (2 * R + 1);
    // The clamped ends and the interface restrain lateral contraction, unlike in ideal bars.
    CHECK(*u == near(0.1 * soft / (1 + soft), {.relative = 0.04}));
}

TEST_CASE("the interface may lie anywhere: cells are stretched to end at it") {
    RatioOptions options = coarse();
    for (const double interface : {0.3, 0.7}) {
        options.interface = interface;
        options.cells[0] = 20;  // a boundary of cells is there
        const auto exact = reference_displacement_mm(options, 4);
        REQUIRE(exact);
        options.cells[0] = 24;  // 7.2 and 16.8 cells
        CHECK(*reference_displacement_mm(options, 4) / *exact == near(1, {.relative = 1e-2}));
    }
    // Without stretched cells the result would jump from one boundary to the next.
    options.interface = 0.26;
    const double a = *reference_displacement_mm(options, 4);
    options.interface = 0.28;
    const double b = *reference_displacement_mm(options, 4);
    CHECK(b / a > 1.04);
}

TEST_CASE("three ratios give a curve through their points") {
    RatioOptions options = coarse();
    options.ratios = {1, 2, 4};
    Progress silent;
    const auto result = calibrate_ratio(options, silent);
    REQUIRE_MESSAGE(result, (result ? "" : result.error().message));
    REQUIRE(result->rows.size() == 3);
    REQUIRE(result->curve);
    for (const RatioRow& row : result->rows) {
        const auto& c = *result->curve;
        const double on_curve = (c[0] * row.material_ratio + c[1]) * row.material_ratio + c[2];
        CHECK(on_curve == near(row.shape_parameter, {.relative = 1e-12}));
    }
    CHECK(ratio_csv(*result).find("material_ratio,interface_mm") == 0);
    CHECK(ratio_json(*result, options).find("\"curve\"") != std::string::npos);
    CHECK(ratio_text(*result).find("T3.8") != std::string::npos);
}

TEST_CASE("invalid options are refused") {
    Progress silent;
    RatioOptions options = coarse();
    CHECK_FALSE(calibrate_ratio(options, silent));
    options.ratios = {0.5};
    CHECK_FALSE(calibrate_ratio(options, silent));
    options.ratios = {2};
    options.poisson_ratio = 0.5;
    CHECK_FALSE(calibrate_ratio(options, silent));
    options.poisson_ratio = 0.45;
    options.interface = 1;
    CHECK_FALSE(calibrate_ratio(options, silent));
    options.interface = 0.5;
    options.cells[0] = 1;  // no boundary between the ends
    CHECK_FALSE(calibrate_ratio(options, silent));
}
