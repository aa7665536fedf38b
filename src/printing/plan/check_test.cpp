#include "printing/plan/check.hpp"

#include <doctest/doctest.h>

#include <string>

#include "base/core/test_text.hpp"
#include "printing/plan/test_jobs.hpp"

using namespace pliant;
using namespace pliant::plan;
using pliant::test::holds;

namespace {

const std::string start = "G90\nG28 Z\nG28 X\nG28 Y\n";
const std::string load = "G1 Y0.5\nG1 X355.6\nG1 Y30\nG1 X0\n";
const std::string light = ";@expose layer=0 material=0 seconds=1 image=a.png\n";

/// The error that the tower gives for `text`; "" if it passes.
std::string gcode_error(const std::string& text) {
    const machine::Printer printer = plan::test::tower();
    const Status status = check_gcode(text, printer);
    return status ? "" : status.error().message;
}

}  // namespace

TEST_CASE("a valid program passes") {
    CHECK(gcode_error(start + load + "G1 Z0.05\nM400\n" + light) == "");
    CHECK(gcode_error("; only a comment\n\nM84 S0\n") == "");
}

TEST_CASE("actions that are never allowed are refused with their line") {
    CHECK(holds(gcode_error("G90\nG1 X10\n"), "G-code line 2: the carriage moves before it is homed"));
    CHECK(holds(gcode_error("G28 Z\nG1 Z10\n"), "a move before G90"));
    CHECK(holds(gcode_error(start + "G1 X355.6\n"), "line 5"));
    CHECK(holds(gcode_error(start + load + "G1 Z0.05\n" + light), "light while the machine moves"));
    CHECK(holds(gcode_error(start + "M400\n" + light), "no vat under the platform"));
    CHECK(holds(gcode_error(start + "G1 Z401\n"), "outside its travel"));
}

TEST_CASE("commands outside the supported dialect are refused") {
    CHECK(holds(gcode_error("G91\n"), "G91 does not belong"));
    CHECK(holds(gcode_error("M112\n"), "M112 is not a command"));
    CHECK(holds(gcode_error("g1 x1\n"), "not a command"));
    CHECK(holds(gcode_error("G28\n"), "G28 without axes"));
    CHECK(holds(gcode_error("M118 " + std::string(95, 'a') + "\n"), "longer than 94"));
    CHECK(holds(gcode_error(";@expose nonsense\n"), "line 1"));
    CHECK(holds(gcode_error(start + "G1 E5\n"), "E is not an axis"));
}

TEST_CASE("G-code of other programs: harmless lines pass, moves are checked as always") {
    CHECK(gcode_error("G21\nM117 hello\nN1 G90*3\nN2 G28 Z*7\nM114\nM105\n") == "");
    CHECK(holds(gcode_error("G21\nG90\nN3 G1 X5*12\n"), "G-code line 3: the carriage moves before it is homed"));
    CHECK(holds(gcode_error("G91\n"), "relative"));
    CHECK(holds(gcode_error(start + "M84\nG1 X5\n"), "line 6: the carriage moves before"));
    CHECK(holds(gcode_error("G92 X0\n"), "G92 moves the origin of X"));
}

TEST_CASE("the pump runs over the drain only, after M400, and not without end") {
    const std::string push = start + load + "G1 X355.6\n";
    CHECK(gcode_error(push + "M400\nM106 P1 S255\nG1 Y0.5\nG1 X335\nM400\nM107 P1\nG1 X0\n") == "");
    CHECK(holds(gcode_error(push + "M106 P1 S255\n"), "M400 before it is missing"));
    CHECK(holds(gcode_error(start + load + "M400\nM106 P1\n"), "the pump starts while the part is not over the drain"));
    CHECK(holds(gcode_error(push + "M400\nM106 P1\nG1 X0\n"), "line 12: a move away from the drain"));
    CHECK(holds(gcode_error(push + "M400\nM106 P1\nG4 S100\nG4 S100\n"), "line 13: the pump runs for over 120 s"));
    CHECK(holds(gcode_error(start + load + "M400\n;@expose layer=0 material=0 seconds=61 image=a\n"),
                "exposure of 61 s"));
}
