#include "core/units.hpp"

#include <doctest/doctest.h>

using namespace pliant;

TEST_CASE("quantities convert to SI") {
    CHECK(*parse_quantity("12 MPa", Dimension::pressure) == doctest::Approx(12e6));
    CHECK(*parse_quantity("50um", Dimension::length) == doctest::Approx(50e-6));
    CHECK(*parse_quantity(" 1040 kg/m^3 ", Dimension::density) == doctest::Approx(1040));
    CHECK(*parse_quantity("-1.5e1 mm", Dimension::length) == doctest::Approx(-0.015));
    CHECK(*parse_quantity("+24 in", Dimension::length) == doctest::Approx(0.6096));
}

TEST_CASE("a quantity without a unit, with a foreign unit or without a number is refused") {
    CHECK(parse_quantity("12", Dimension::pressure).error().message.find("has no unit") != std::string::npos);
    CHECK(parse_quantity("12 mm", Dimension::pressure).error().message.find("MPa") != std::string::npos);
    for (const char* text : {"", "MPa", "nan MPa", "inf MPa", "1 2 MPa", "1e999 MPa", "0x10 MPa"}) {
        CAPTURE(text);
        CHECK_FALSE(parse_quantity(text, Dimension::pressure));
    }
}
