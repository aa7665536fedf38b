#include "machine/cleaning_data.hpp"

#include <doctest/doctest.h>

using namespace pliant::machine;

TEST_CASE("the law goes through the means of table 4.2") {
    const auto tests = cleaning_tests();
    CHECK(cleaning_law(CleaningMethod::spray).removed(15) == doctest::Approx(tests[0].mean()));
    CHECK(cleaning_law(CleaningMethod::ultrasound).removed(15) == doctest::Approx(tests[1].mean()));
    CHECK(cleaning_law(CleaningMethod::ultrasound).removed(120) == doctest::Approx(tests[2].mean()));
    CHECK(tests[0].mean() == doctest::Approx(0.9475));
    CHECK(cleaning_law(CleaningMethod::spray).removed(0) == 0);
    CHECK(cleaning_law(CleaningMethod::spray).removed(1e6) == doctest::Approx(1));
    CHECK(cleaning_law(CleaningMethod::ultrasound).removed(1e6) < 0.7);
}
