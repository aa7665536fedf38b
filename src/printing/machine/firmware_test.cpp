#include "printing/machine/firmware.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "base/core/files.hpp"
#include "printing/machine/switches.hpp"
#include "printing/machine/test_marlin.hpp"

using namespace pliant;
using namespace pliant::machine;

namespace {

Printer load(const std::string& name) {
    return load_printer("examples/printers/" + name + ".toml").value();
}

std::string value(const std::vector<FirmwareSetting>& settings, const std::string& name) {
    const auto found = std::find_if(settings.begin(), settings.end(), [&](const auto& s) { return s.name == name; });
    return found == settings.end() ? "(not there)" : found->value;
}

constexpr std::array releases = {MarlinRelease::v2_1_1, MarlinRelease::v2_1_2, MarlinRelease::v2_1_3};

/// The errors that Marlin's SanityCheck.h would give, one line each.
std::string sanity_problems(const Printer& printer) {
    const auto list = firmware_settings(printer);
    REQUIRE_MESSAGE(list, (list ? "" : list.error().message));
    std::string text;
    for (const std::string& problem : machine::test::marlin_problems(*list, printer.controller.firmware))
        text += printer.name + " on " + std::string(name_of(printer.controller.firmware)) + ": " + problem + "\n";
    return text;
}

/// Adds drives if the machine's file has none: the rules are about names, not about sizes.
Printer with_drives(Printer printer) {
    for (AxisSpec& axis : printer.axes) {
        if (!axis.drive.known()) axis.drive.per_turn_mm = 8;
    }
    return printer;
}

}  // namespace

TEST_CASE("the lists in firmware/ are those of the printer files") {
    for (const std::string name : {"tower", "tower8"}) {
        for (const MarlinRelease release : releases) {
            Printer printer = load(name);
            printer.controller.firmware = release;
            const auto ini = firmware_ini(printer);
            REQUIRE_MESSAGE(ini, (ini ? "" : ini.error().message));
            const std::string file = "firmware/" + name + (release == MarlinRelease::v2_1_3 ? "-2.1.3.ini" : ".ini");
            CHECK_MESSAGE(read_file(file).value() == *ini, "write it anew: pliant firmware examples/printers/"
                                                               << name << ".toml --release " << name_of(release)
                                                               << " -o " << file);
        }
    }
}

TEST_CASE("the settings of every example printer obey names and rules of every release") {
    for (const auto& entry : std::filesystem::directory_iterator("examples/printers")) {
        if (entry.path().extension() != ".toml") continue;
        Printer printer = with_drives(load(entry.path().stem().string()));
        if (printer.controller.dialect != Dialect::marlin) continue;
        for (const MarlinRelease release : releases) {
            printer.controller.firmware = release;
            CHECK(sanity_problems(printer) == "");
        }
    }
}

TEST_CASE("the settings obey the rules also with a far switch, a door, jerk and an unusual name") {
    for (const MarlinRelease release : releases) {
        Printer printer = load("tower8");
        printer.controller.firmware = release;
        printer.name = "50 % \"tower\"; #2 \\ $x";
        printer.axes[0].jerk_mm_s = 2;
        for (const std::string door : {"y_max", "y_min", "z_min", "x_max", "z_probe", "filament"}) {
            printer.door.input = door;
            CHECK(sanity_problems(printer) == "");
        }
        printer.door = {"y_min", true};  // where the stand-in Y would home
        const bool newer = release == MarlinRelease::v2_1_3;
        CHECK(value(firmware_settings(printer).value(),
                    newer ? "Y_MIN_ENDSTOP_HIT_STATE" : "Y_MIN_ENDSTOP_INVERTING") == (newer ? "LOW" : "true"));
        printer.door = {};
        printer.limit_switches = switches_of(printer);
        printer.limit_switches.push_back({Axis::platform, false, true});
        CHECK(sanity_problems(printer) == "");
    }
}

TEST_CASE("the rules find settings that no release compiles, and those that 2.1.3 refuses") {
    const auto broken = [](MarlinRelease release, const std::string& name, const std::string& value) {
        Printer printer = load("tower8");
        printer.controller.firmware = release;
        auto list = firmware_settings(printer).value();
        std::erase_if(list, [&](const FirmwareSetting& s) { return s.name == name; });
        if (!value.empty()) list.push_back({name, value, ""});
        std::string text;
        for (const std::string& problem : machine::test::marlin_problems(list, release)) text += problem + "\n";
        return text;
    };
    for (const MarlinRelease release : releases) {
        CHECK(broken(release, "AXIS_RELATIVE_MODES", "") == "AXIS_RELATIVE_MODES is required with EXTRUDERS 0\n");
        CHECK(broken(release, "AXIS_RELATIVE_MODES", "{ false, false, false }") ==
              "AXIS_RELATIVE_MODES has 3 entries for 4 axes\n");
        CHECK(broken(release, "I_ENABLE_ON", "") == "I_ENABLE_ON is required with the axis I\n");
        CHECK(broken(release, "INVERT_I_DIR", "") == "INVERT_I_DIR is required with the axis I\n");
        CHECK(broken(release, "I_MIN_PIN", "3") == "I_MIN_PIN is pin 3, which X_MIN has\n");
        CHECK(broken(release, "HOMING_BUMP_DIVISOR", "{ 4, 4, 0, 4 }") ==
              "HOMING_BUMP_DIVISOR: { 4, 4, 0, 4 } is too small\n");
    }
    for (const char* old : {"DEFAULT_STEPPER_DEACTIVE_TIME", "USE_XMIN_PLUG", "X_MIN_ENDSTOP_INVERTING"})
        CHECK(broken(MarlinRelease::v2_1_3, old, "0") == std::string(old) + " is not known\n");
    for (const char* later : {"DEFAULT_STEPPER_TIMEOUT_SEC", "X_MIN_ENDSTOP_HIT_STATE"})
        CHECK(broken(MarlinRelease::v2_1_2, later, "0") == std::string(later) + " is not known\n");
}

TEST_CASE("rotary axes come before linear extra axes, and have the names that M119 uses") {
    const Printer carousel = with_drives(load("carousel"));
    const auto settings = firmware_settings(carousel).value();
    CHECK(value(settings, "AXIS4_NAME") == "'C'");
    CHECK(value(settings, "AXIS4_ROTATES") == "on");
    CHECK(value(settings, "AXIS5_NAME") == "'A'");
    CHECK(value(settings, "AXIS5_ROTATES") == "off");
    CHECK(switch_names(carousel, {Axis::table, false, false}) == std::vector<std::string>{"c_min", "i_min"});
    CHECK(switch_names(carousel, {Axis::tower, false, false}) == std::vector<std::string>{"a_min", "j_min"});
}

TEST_CASE("settings renamed in 2.1.3 have their new names") {
    Printer printer = load("tower");
    printer.controller.firmware = MarlinRelease::v2_1_3;
    printer.door = {"y_max", true};
    const auto settings = firmware_settings(printer).value();
    CHECK(value(settings, "DEFAULT_STEPPER_TIMEOUT_SEC") == "0");
    CHECK(value(settings, "X_MIN_ENDSTOP_HIT_STATE") == "HIGH");  // a broken wire counts as pressed
    CHECK(value(settings, "Y_SAFETY_STOP") == "on");
    CHECK(value(settings, "Y_MAX_ENDSTOP_HIT_STATE") == "LOW");
    CHECK(value(settings, "Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN") == "off");
    CHECK(firmware_ini(printer)->starts_with("# Marlin 2.1.3 for the machine \"tower prototype\""));
}

TEST_CASE("the settings are in the one section that the scripts of all releases read") {
    // The build script of 2.1.1 takes "all" for the name of a section, and fails.
    for (const MarlinRelease release : releases) {
        Printer printer = load("tower");
        printer.controller.firmware = release;
        const std::string ini = firmware_ini(printer).value();
        CHECK(ini.find("[config:base]\nini_use_config = base\n") != std::string::npos);
        CHECK(ini.find("\n[", ini.find("[config:base]")) == std::string::npos);
    }
}

TEST_CASE("gears, pinions and screws give steps per mm; the tower is a linear axis of its own") {
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

TEST_CASE("impossible builds are refused with a reason") {
    CHECK(firmware_settings(load("rotary")).error().message.find("give per_turn") != std::string::npos);
    Printer fast = load("tower8");
    fast.axes[0].drive.microsteps = 64;
    CHECK(firmware_settings(fast).error().message.find("fewer microsteps") != std::string::npos);
    Printer classic = load("tower");
    classic.controller.dialect = Dialect::classic;
    CHECK_FALSE(firmware_settings(classic));
    Printer motors = with_drives(load("carousel"));
    motors.axes[static_cast<std::size_t>(Axis::platform)].drive.motors = 2;  // five in all, but Marlin also needs a Y
    CHECK(firmware_settings(motors).error().message.find("no free socket") != std::string::npos);
}

TEST_CASE("with a magnet or a fork, M42 may write to its pin, which must be free") {
    for (const char* name : {"tower_magnet", "wall"}) {
        Printer printer = load_printer(std::string("examples/printers/") + name + ".toml").value();
        for (const MarlinRelease release : {MarlinRelease::v2_1_1, MarlinRelease::v2_1_2, MarlinRelease::v2_1_3}) {
            printer.controller.firmware = release;
            const auto list = firmware_settings(printer);
            REQUIRE_MESSAGE(list, (list ? "" : list.error().message));
            const auto problems = machine::test::marlin_problems(*list, release);
            CHECK_MESSAGE(problems.empty(), (problems.empty() ? "" : problems.front()));
            CHECK(std::count_if(list->begin(), list->end(), [](const FirmwareSetting& s) {
                      return s.name == "DIRECT_PIN_CONTROL" && s.value == "on";
                  }) == 1);
        }
        Switch& device = printer.hooks.magnet.present() ? printer.hooks.magnet.coil : printer.wall.fork;
        device = {"M42 P26 S255", "M42 P26 S0"};
        const auto taken = firmware_settings(printer);
        REQUIRE_FALSE(taken);
        CHECK(taken.error().message.find("that pin is ") != std::string::npos);
    }
    const auto hooks = firmware_settings(load_printer("examples/printers/tower.toml").value()).value();
    CHECK(std::none_of(hooks.begin(), hooks.end(), [](const auto& s) { return s.name == "DIRECT_PIN_CONTROL"; }));
}
