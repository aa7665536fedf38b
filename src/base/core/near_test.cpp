#include "base/core/near.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <type_traits>

using namespace pliant;

TEST_CASE("a small number is not near another one because both are small") {
    CHECK_FALSE(0.0 == near(1.9e-6, {.relative = 1e-2}));  // accepted by doctest::Approx
    CHECK_FALSE(1.9e-6 == near(0, {.relative = 1e-2}));
    CHECK_FALSE(1.6e-5 == near(1.7e-5, {.relative = 1e-2}));
    CHECK(1.69e-5 == near(1.7e-5, {.relative = 1e-2}));
}

TEST_CASE("the larger tolerance counts, and its limit is included") {
    CHECK(1.5 == near(1, {.relative = 0.5}));
    CHECK(0.5 == near(1, {.absolute = 0.5}));
    CHECK_FALSE(1.500001 == near(1, {.relative = 0.5}));
    CHECK(-1.5 == near(-1, {.relative = 0.5}));
    CHECK(11.0 == near(10, {.relative = 0.1, .absolute = 0.01}));
    CHECK(0.005 == near(0, {.relative = 0.1, .absolute = 0.01}));
    CHECK_FALSE(0.02 == near(0.01, {.relative = 0.1, .absolute = 0.001}));
}

TEST_CASE("without a tolerance numbers must be equal, and there is no default") {
    CHECK(0.1 == near(0.1, {}));
    CHECK_FALSE(0.1 == near(0.1 + 1e-16 * 2, {}));
    CHECK_FALSE(std::is_invocable_v<decltype(near), double>);
    CHECK_FALSE(std::is_convertible_v<double, Near>);
}

TEST_CASE("NaN is near nothing, and infinity only near itself") {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
    CHECK_FALSE(nan == near(1, {.relative = 1, .absolute = 1e300}));
    CHECK_FALSE(nan == near(nan, {.absolute = infinite}));
    CHECK_FALSE(1.0 == near(nan, {.absolute = 1}));
    CHECK(infinite == near(infinite, {.relative = 1e-6}));
    CHECK_FALSE(infinite == near(-infinite, {.relative = 1e-6}));
    CHECK_FALSE(1.0 == near(infinite, {.relative = 1e-6}));
    CHECK_FALSE(infinite == near(1, {.absolute = 1e300}));
    CHECK(nan != near(nan, {.relative = 1}));
}

TEST_CASE("integers are compared with tolerances too") {
    const std::size_t count = 99;
    CHECK(count == near(100, {.relative = 0.01}));
    CHECK(count != near(100, {.relative = 0.001}));
}

TEST_CASE("a failed check shows measured, expected, deviation and tolerance") {
    const Near wanted = near(2.5e-3, {.relative = 1e-2});
    REQUIRE_FALSE(2.25e-3 == wanted);
    const std::string text = toString(wanted).c_str();
    CHECK(text == "near 0.0025 (measured 0.00225, off by 0.00025, allowed 2.5e-05)");
}
