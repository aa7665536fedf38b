#include "printing/machine/cleaning_data.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"

using namespace pliant::machine;
using pliant::near;

TEST_CASE("the cleaning law fits the means of table 4.2") {
    const auto tests = cleaning_tests();
    CHECK(cleaning_law(CleaningMethod::spray).removed(15) == near(tests[0].mean(), {.relative = 1e-12}));
    CHECK(cleaning_law(CleaningMethod::ultrasound).removed(15) == near(tests[1].mean(), {.relative = 1e-12}));
    CHECK(cleaning_law(CleaningMethod::ultrasound).removed(120) == near(tests[2].mean(), {.relative = 1e-12}));
    CHECK(tests[0].mean() == near(0.9475, {.relative = 1e-12}));
    CHECK(cleaning_law(CleaningMethod::spray).removed(0) == 0);
    CHECK(cleaning_law(CleaningMethod::spray).removed(1e6) == near(1, {.relative = 1e-12}));
    CHECK(cleaning_law(CleaningMethod::ultrasound).removed(1e6) < 0.7);
}
