#include "printing/machine/board_report.hpp"

#include <doctest/doctest.h>

#include "base/core/test_text.hpp"

using namespace pliant;
using namespace pliant::machine;
using pliant::test::replaced;

namespace {

/// A board configured for tower8, with Marlin's answers; the values are calculated by hand.
const std::string good_board =
    "FIRMWARE_NAME:Marlin 2.1.2 (Jan  1 2024) SOURCE_CODE_URL:x PROTOCOL_VERSION:1.0 MACHINE_TYPE:tower "
    "EXTRUDER_COUNT:0\nCap:EEPROM:0\nCap:SOFTWARE_POWER:1\nCap:EMERGENCY_PARSER:1\nok\n"
    "echo:; Steps per unit:\necho:  M92 X525.21 Y80.00 Z800.00 A315.13\n"
    "echo:; Max feedrates (units/s):\necho:  M203 X15.20 Y1.00 Z20.00 A40.00\n"
    "echo:; Max Acceleration (units/s2):\necho:  M201 X50.00 Y1.00 Z100.00 A200.00\n"
    "echo:; Acceleration (units/s2) (P<print-accel> R<retract-accel> T<travel-accel>):\n"
    "echo:  M204 P200.00 R3000.00 T200.00\n"
    "echo:; Home offset:\necho:  M206 X0.00 Y0.00 Z0.00 A0.00\nok\n"
    "echo:; Soft endstops:\necho:  M211 S1 ; ON\n"
    "echo:  Min:  X0.00 Y0.00 Z0.00 A0.00   Max:  X358.00 Y1.00 Z400.00 A1460.00\nok\n"
    "Reporting endstop status\nx_min: open\ny_min: TRIGGERED\nz_max: open\ni_min: open\nok\necho:M113 S2\nok\n";

std::vector<std::string> problems(const std::string& text, const std::string& what = "", const std::string& with = "") {
    return check_board(parse_board_report(what.empty() ? text : replaced(text, what, with)),
                       load_printer("examples/printers/tower8.toml").value());
}

std::string only_problem(const std::string& what, const std::string& with) {
    const auto found = problems(good_board, what, with);
    REQUIRE_MESSAGE(found.size() == 1, what);
    return found[0];
}

}  // namespace

TEST_CASE("a board that fits its printer has no problems; every difference is one, with a remedy") {
    CHECK(problems(good_board).empty());
    CHECK(only_problem("PARSER:1", "PARSER:0").find("EMERGENCY_PARSER") != std::string::npos);
    CHECK(only_problem("X525.21", "X80.00").find("M92 X is 80, the printer file has 525.2129") != std::string::npos);
    CHECK(only_problem(" A40.00", "").find("M203 does not name A (the tower)") != std::string::npos);
    CHECK(only_problem("Z100.00", "Z50.00").find("M201 Z is 50") != std::string::npos);
    CHECK(only_problem("z_max", "z_min").find("no z_max: the platform homes there") != std::string::npos);
    CHECK(only_problem("echo:M113 S2", "").find("HOST_KEEPALIVE") != std::string::npos);
    CHECK(only_problem("M113 S2", "M113 S0").find("M113") == 0);
    CHECK(only_problem("COUNT:0", "COUNT:1").find("EXTRUDERS 0") != std::string::npos);
    CHECK(only_problem("FIRMWARE_NAME:Marlin 2.1.2", "FIRMWARE_NAME:Other 1").find("not a Marlin") !=
          std::string::npos);
    CHECK(only_problem("X525.21", "X5B5.21").find("does not name X") != std::string::npos);  // damaged on the wire
    CHECK(problems("").size() == 1);
    CHECK(problems("ok\nok\n")[0].find("M115") == 0);
}

TEST_CASE("accelerations of all moves, home offsets, soft endstops and the power's relay are compared too") {
    CHECK(only_problem("P200.00", "P100.00") ==
          "M503: M204 P is 100, which slows axes of up to 200 mm/s^2: send M204 P200");
    CHECK(only_problem("T200.00", "T150.00").find("M204 T is 150") != std::string::npos);
    CHECK(problems(good_board, "T200.00", "T3000.00").empty());  // each axis is limited by its own M201
    CHECK(only_problem("  M204 P200.00 R3000.00 T200.00", "") == "M503: does not say M204");
    CHECK(only_problem("M206 X0.00 Y0.00 Z0.00", "M206 X0.00 Y0.00 Z-1.50") ==
          "M503: M206 Z is -1.5: the platform stands that far from where it is told: send M206 Z0");
    CHECK(problems(good_board, "  M206 X0.00 Y0.00 Z0.00 A0.00", "").empty());  // built without M206
    CHECK(only_problem("M211 S1 ; ON", "M211 S0 ; OFF").find("send M211 S1") != std::string::npos);
    CHECK(only_problem("X358.00", "X200.00") ==
          "M211: X may go from 0 to 200, the printer file has 0 to 358: build with X_MIN_POS and X_MAX_POS of the "
          "travel");
    CHECK(only_problem("A1460.00", "A50.00").find("I_MIN_POS and I_MAX_POS") != std::string::npos);
    CHECK(only_problem(" A1460.00", " A14x0.00").find("does not say how far A (the tower) may go") !=
          std::string::npos);
    CHECK(problems(good_board, "X358.00", "X360.00").empty());
    CHECK(only_problem("SOFTWARE_POWER:1", "SOFTWARE_POWER:0").find("build with PSU_CONTROL") != std::string::npos);
    std::string silent = replaced(good_board, "echo:  M211 S1 ; ON\n", "");
    silent = replaced(silent, "echo:  Min:  X0.00 Y0.00 Z0.00 A0.00   Max:  X358.00 Y1.00 Z400.00 A1460.00\n", "");
    CHECK(problems(silent).size() == 1);
    CHECK(problems(silent)[0].find("M211: no answer") == 0);
}

TEST_CASE("the tower on a classic build's extruder needs no soft endstops") {
    Printer printer = load_printer("examples/printers/tower8.toml").value();
    printer.controller.dialect = Dialect::classic;
    printer.axes[static_cast<std::size_t>(Axis::tower)].letter = 'E';
    const std::string text = replaced(good_board, "A1460.00", "");
    for (const std::string& problem : check_board(parse_board_report(text), printer))
        CHECK_MESSAGE(problem.find("M211") == std::string::npos, problem);
}

TEST_CASE("soft endstops are read in the form of older releases") {
    const BoardReport board =
        parse_board_report("echo:Soft endstops: Off  Min: X:0.00 Y:-5.00   Max: X:200.00 Y:210.50\n");
    CHECK(board.soft_endstops == false);
    CHECK(board.soft_min.at('Y') == -5);
    CHECK(board.soft_max.at('Y') == 210.5);
}
