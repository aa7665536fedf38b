#include "machine/firmware.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "core/files.hpp"
#include "core/test_text.hpp"

using namespace pliant;
using namespace pliant::machine;
using pliant::test::replaced;

namespace {

Printer load(const std::string& name) {
    return load_printer("examples/printers/" + name + ".toml").value();
}

std::string value(const std::vector<FirmwareSetting>& settings, const std::string& name) {
    const auto found = std::find_if(settings.begin(), settings.end(), [&](const auto& s) { return s.name == name; });
    return found == settings.end() ? "(not there)" : found->value;
}

/// A board built by the list for tower8, as Marlin answers; the arithmetic is by hand.
const std::string good_board =
    "FIRMWARE_NAME:Marlin 2.1.2 (Jan  1 2024) SOURCE_CODE_URL:x PROTOCOL_VERSION:1.0 MACHINE_TYPE:tower "
    "EXTRUDER_COUNT:0\nCap:EEPROM:0\nCap:EMERGENCY_PARSER:1\nok\n"
    "echo:; Steps per unit:\necho:  M92 X525.21 Y80.00 Z800.00 A315.13\n"
    "echo:; Max feedrates (units/s):\necho:  M203 X15.20 Y1.00 Z20.00 A40.00\n"
    "echo:; Max Acceleration (units/s2):\necho:  M201 X50.00 Y1.00 Z100.00 A200.00\nok\n"
    "Reporting endstop status\nx_min: open\ny_min: TRIGGERED\nz_max: open\ni_min: open\nok\necho:M113 S2\nok\n";

std::vector<std::string> problems(const std::string& text, const std::string& what = "", const std::string& with = "") {
    return check_board(parse_board_report(what.empty() ? text : replaced(text, what, with)), load("tower8"));
}

}  // namespace

TEST_CASE("the lists in firmware/ are what the printer files ask for") {
    for (const std::string name : {"tower", "tower8"}) {
        const auto ini = firmware_ini(load(name));
        REQUIRE_MESSAGE(ini, (ini ? "" : ini.error().message));
        CHECK_MESSAGE(
            read_file("firmware/" + name + ".ini").value() == *ini,
            "write it anew: pliant firmware examples/printers/" << name << ".toml -o firmware/" << name << ".ini");
    }
}

TEST_CASE("gear, pinion and screws become steps; the tower is a linear axis of its own") {
    const auto settings = firmware_settings(load("tower8")).value();
    // 200 x 4 x 99 / 150.796; stand-in; 200 x 16 / 4; 200 x 4 x 99 / 251.327
    CHECK(value(settings, "DEFAULT_AXIS_STEPS_PER_UNIT") == "{ 525.2129, 80, 800, 315.1273 }");
    CHECK(value(settings, "AXIS4_NAME") == "'A'");
    CHECK(value(settings, "AXIS4_ROTATES") == "off");
    CHECK(value(settings, "Z2_STEP_PIN") == "26");
    CHECK(value(settings, "I_STEP_PIN") == "36");
    CHECK(value(settings, "Z_HOME_DIR") == "1");
    CHECK(value(settings, "X_HOME_DIR") == "-1");
    CHECK(value(settings, "EXTRUDERS") == "0");
    CHECK(value(settings, "EMERGENCY_PARSER") == "on");
    const auto three = firmware_settings(load("tower")).value();
    CHECK(value(three, "DEFAULT_AXIS_STEPS_PER_UNIT") == "{ 525.2129, 315.1273, 800 }");
    CHECK(value(three, "I_DRIVER_TYPE") == "(not there)");
}

TEST_CASE("what cannot be built says why") {
    CHECK(firmware_settings(load("rotary")).error().message.find("give per_turn") != std::string::npos);
    Printer fast = load("tower8");
    fast.axes[0].drive.microsteps = 64;
    CHECK(firmware_settings(fast).error().message.find("fewer microsteps") != std::string::npos);
    Printer classic = load("tower");
    classic.controller.dialect = Dialect::classic;
    CHECK_FALSE(firmware_settings(classic));
}

TEST_CASE("a board that fits has no problems; every difference is one, with what to do") {
    CHECK(problems(good_board).empty());
    const auto first = [&](const std::string& what, const std::string& with) {
        const auto found = problems(good_board, what, with);
        REQUIRE(found.size() == 1);
        return found[0];
    };
    CHECK(first("PARSER:1", "PARSER:0").find("EMERGENCY_PARSER") != std::string::npos);
    CHECK(first("X525.21", "X80.00").find("M92 X is 80, the printer file has 525.2129") != std::string::npos);
    CHECK(first(" A40.00", "").find("M203 does not name A (the tower)") != std::string::npos);
    CHECK(first("Z100.00", "Z50.00").find("M201 Z is 50") != std::string::npos);
    CHECK(first("z_max", "z_min").find("no z_max: the platform homes there") != std::string::npos);
    CHECK(first("echo:M113 S2", "").find("HOST_KEEPALIVE") != std::string::npos);
    CHECK(first("M113 S2", "M113 S0").find("M113") == 0);
    CHECK(first("COUNT:0", "COUNT:1").find("EXTRUDERS 0") != std::string::npos);
    CHECK(first("FIRMWARE_NAME:Marlin 2.1.2", "FIRMWARE_NAME:Other 1").find("not a Marlin") != std::string::npos);
    CHECK(first("X525.21", "X5B5.21").find("does not name X") != std::string::npos);  // damaged on the wire
    CHECK(problems("").size() == 1);
    CHECK(problems("ok\nok\n")[0].find("M115") == 0);
}
