#include "printing/prepare/option_text.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::prepare;

TEST_CASE("a length has a unit and is converted to micrometres") {
    CHECK(*length_um("--x", "0.4 mm", 7) == near(400, {.relative = 1e-12}));
    CHECK(*length_um("--x", "25 um", 7) == near(25, {.relative = 1e-12}));
    CHECK(*length_um("--x", "-1 cm", 7) == near(-10000, {.relative = 1e-12}));
    CHECK(*length_um("--x", "", 7) == 7);
    for (const char* wrong : {"5", "mm", "5 s", "5 mm 3", "nan mm", "1e400 mm", " ", "five mm"}) {
        CAPTURE(wrong);
        const auto length = length_um("--x", wrong, 7);
        REQUIRE(!length.has_value());
        CHECK(length.error().cause == Cause::input);
        CHECK(length.error().message.find("--x: ") == 0);
    }
    CHECK(length_um("--x", "1e303 m", 7).error().message == "--x 1e303 m: is not a possible length");
}

TEST_CASE("a length may be at its limits and not beyond") {
    CHECK(*length_um("--x", "1 um", 7, 1, 10000) == near(1, {.relative = 1e-12}));
    CHECK(*length_um("--x", "10 mm", 7, 1, 10000) == near(10000, {.relative = 1e-12}));
    CHECK(*length_um("--x", "", 0, 1, 10000) == 0);  // missing values are not checked
    CHECK(length_um("--x", "0.99 um", 7, 1, 10000).error().message == "--x 0.99 um: must be 0.001 to 10 mm");
    CHECK(!length_um("--x", "10.001 mm", 7, 1, 10000).has_value());
    CHECK(!length_um("--x", "-5 mm", 7, 1, 10000).has_value());
}

TEST_CASE("layers are whole micrometres from 1 to 1000") {
    CHECK(*layer_height_um("--layer", "50 um") == 50);
    CHECK(*layer_height_um("--layer", "0.05 mm") == 50);
    CHECK(*layer_height_um("--layer", "1 um") == 1);
    CHECK(*layer_height_um("--layer", "1 mm") == 1000);
    for (const char* wrong : {"0 um", "0.5 um", "50.5 um", "1001 um", "-50 um", "1e30 m", ""}) {
        CAPTURE(wrong);
        const auto height = layer_height_um("--layer", wrong);
        REQUIRE(!height.has_value());
        CHECK(height.error().message.find("a whole number of micrometres from 1 to 1000 is needed") !=
              std::string::npos);
    }
    CHECK(layer_height_um("--layer", "50").error().message.find("--layer: ") == 0);
}

TEST_CASE("a plain number has no sign, blanks or unit") {
    CHECK(plain_number("0") == 0);
    CHECK(plain_number("12") == 12);
    for (const char* wrong : {"", "-", "1.5", " 1", "1 ", "+1", "0x1", "99999999999", "-3"})
        CHECK(plain_number(wrong) == -1);
    CHECK(*plain_degrees("--angle", "45") == 45);
    CHECK(*plain_degrees("--angle", "-0.5") == -0.5);
    for (const char* wrong : {"", "45 deg", "nan", "inf", "1e400", " 4"}) {
        CAPTURE(wrong);
        const auto degrees = plain_degrees("--angle", wrong);
        REQUIRE(!degrees.has_value());
        CHECK(degrees.error().message.find("a number of degrees is needed") != std::string::npos);
    }
}
