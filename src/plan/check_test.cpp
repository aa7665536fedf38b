#include "plan/check.hpp"

#include <doctest/doctest.h>

#include <string>

#include "plan/test_jobs.hpp"

using namespace pliant;
using namespace pliant::plan;

namespace {

const std::string start = "G90\nG28 Z\nG28 X\nG28 Y\n";
const std::string load = "G1 Y0.5\nG1 X355.6\nG1 Y30\nG1 X0\n";
const std::string light = ";@expose layer=0 material=0 seconds=1 image=a.png\n";

/// The error that the tower gives for `text`; "" if it passes.
std::string error_of(const std::string& text) {
    const machine::Printer printer = test::tower();
    const Status status = check_gcode(text, printer);
    return status ? "" : status.error().message;
}

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a proper sequence passes") {
    CHECK(error_of(start + load + "G1 Z0.05\nM400\n" + light) == "");
    CHECK(error_of("; only a comment\n\nM84 S0\n") == "");
}

TEST_CASE("what the machine must never do is named with its line") {
    CHECK(holds(error_of("G90\nG1 X10\n"), "G-code line 2: the carriage moves before it is homed"));
    CHECK(holds(error_of("G28 Z\nG1 Z10\n"), "a move before G90"));
    CHECK(holds(error_of(start + "G1 X355.6\n"), "line 5"));
    CHECK(holds(error_of(start + load + "G1 Z0.05\n" + light), "light while the machine moves"));
    CHECK(holds(error_of(start + "M400\n" + light), "no vat under the platform"));
    CHECK(holds(error_of(start + "G1 Z401\n"), "outside its travel"));
}

TEST_CASE("what is not the dialect is refused") {
    CHECK(holds(error_of("G91\n"), "G91 does not belong"));
    CHECK(holds(error_of("M112\n"), "M112 does not belong"));
    CHECK(holds(error_of("g1 x1\n"), "not a command"));
    CHECK(holds(error_of("G28\n"), "G28 without axes"));
    CHECK(holds(error_of("M118 " + std::string(95, 'a') + "\n"), "longer than 94"));
    CHECK(holds(error_of(";@expose nonsense\n"), "line 1"));
    CHECK(holds(error_of(start + "G1 E5\n"), "E is not an axis"));
}
