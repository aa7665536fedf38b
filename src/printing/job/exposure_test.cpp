#include "printing/job/exposure.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"

using namespace pliant::job;
using pliant::near;

namespace {
const Material soft{"soft", "flex", 0, 0, 2, 12};
}

TEST_CASE("bottom, transition and normal layers have their exposures") {
    const ExposureRule rule{3, 4, 0, 50};
    const double wanted[] = {12, 12, 12, 10, 8, 6, 4, 2, 2};
    for (int k = 0; k < 9; ++k) CHECK(exposure_s(soft, rule, k, 50) == near(wanted[k], {.relative = 1e-12}));
}

TEST_CASE("the exposure of thicker layers follows the working curve; a span's exposure is used as given") {
    ExposureRule rule{0, 0, 100, 50};
    CHECK(exposure_s(soft, rule, 5, 50) == 2);
    CHECK(exposure_s(soft, rule, 5, 100) == near(2 * std::exp(0.5), {.relative = 1e-3}));
    CHECK(exposure_s(soft, rule, 5, 25) == near(2 * std::exp(-0.25), {.relative = 1e-3}));
    rule.spans = {{4, 6, 7.5}, {6, 6, 1.25}};
    CHECK(exposure_s(soft, rule, 5, 100) == 7.5);
    CHECK(exposure_s(soft, rule, 6, 100) == 1.25);
    CHECK(check(rule, "soft").has_value());
    rule.spans = {{6, 4, 7}};
    CHECK(check(rule, "soft").error().message == "soft: exposure of layers 6 to 4: they count from 0 upwards");
    rule.spans = {{0, 4, 4000}};
    CHECK(!check(rule, "soft").has_value());
}
