#include "base/core/units.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"

using namespace pliant;

TEST_CASE("quantities convert to SI") {
    CHECK(*parse_quantity("12 MPa", Dimension::pressure) == near(12e6, {.relative = 1e-12}));
    CHECK(*parse_quantity("50um", Dimension::length) == near(50e-6, {.relative = 1e-12}));
    CHECK(*parse_quantity(" 1040 kg/m^3 ", Dimension::density) == near(1040, {.relative = 1e-12}));
    CHECK(*parse_quantity("-1.5e1 mm", Dimension::length) == near(-0.015, {.relative = 1e-12}));
    CHECK(*parse_quantity("+24 in", Dimension::length) == near(0.6096, {.relative = 1e-12}));
    for (const char* text : {"15 N mm", "15 N*mm", "15N * mm"})
        CHECK(*parse_quantity(text, Dimension::torque) == near(0.015, {.relative = 1e-12}));
    CHECK(*parse_quantity("1 N m/deg", Dimension::torsional_stiffness) == near(57.29577951308232, {.relative = 1e-12}));
}

TEST_CASE("the Greek letter mu is the sign of micro") {
    CHECK(*parse_quantity("5 \xCE\xBCm", Dimension::length) == near(5e-6, {.relative = 1e-12}));
    CHECK(*parse_quantity("5 \xC2\xB5m", Dimension::length) == near(5e-6, {.relative = 1e-12}));
}

TEST_CASE("a decimal comma is told") {
    CHECK(parse_quantity("1,2 MPa", Dimension::pressure).error().message ==
          "\"1,2 MPa\" has a decimal comma; write a point: \"1.2 MPa\"");
}

TEST_CASE("a quantity without a unit, with a foreign unit or without a number is refused") {
    CHECK(parse_quantity("1e308 GPa", Dimension::pressure).error().message == "\"1e308 GPa\" is too large");
    CHECK_FALSE(parse_quantity("+-5 mm", Dimension::length));
    CHECK_FALSE(parse_quantity("++5 mm", Dimension::length));
    CHECK(parse_quantity("12", Dimension::pressure).error().message.find("has no unit") != std::string::npos);
    CHECK(parse_quantity("12 mm", Dimension::pressure).error().message.find("MPa") != std::string::npos);
    for (const char* text : {"", "MPa", "nan MPa", "inf MPa", "1 2 MPa", "1e999 MPa", "0x10 MPa"}) {
        CAPTURE(text);
        CHECK_FALSE(parse_quantity(text, Dimension::pressure));
    }
}
