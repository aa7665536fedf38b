#include "printing/machine/marlin_files.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <set>

#include "printing/machine/define_lines.hpp"
#include "printing/machine/test_marlin.hpp"

using namespace pliant;
using namespace pliant::machine;

namespace {

Printer tower8(MarlinRelease release) {
    Printer printer = load_printer("examples/printers/tower8.toml").value();
    printer.controller.firmware = release;
    return printer;
}

std::string digits(MarlinRelease release) {
    constexpr std::array<const char*, 3> texts = {"02010100", "02010201", "02010300"};
    return texts[static_cast<std::size_t>(release)];
}

/// Files with every name that the release knows, alternately on, off and indented, and without pins, as in Marlin's.
std::array<MarlinFile, 2> stock(MarlinRelease release) {
    std::string text = fmt::format(
        "#pragma once\n/**\n * Settings.\n */\n#define CONFIGURATION_H_VERSION {}\n"
        "#define STRING_CONFIG_H_AUTHOR \"(none, default config)\" // who\n",
        digits(release));
    int turn = 0;
    for (const std::string& name : machine::test::marlin_names(release)) {
        if (name.ends_with("_PIN") && name != "Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN") continue;
        constexpr std::array<const char*, 4> forms = {"#define {}\n", "//#define {} 3 // three\n",
                                                      "#if 1\n  #define {}  {{ 1, \\\n 2 }}\n#endif\n",
                                                      "  //#define {}\n"};
        text += fmt::format(fmt::runtime(forms[static_cast<std::size_t>(turn++ % 4)]), name);
    }
    return {MarlinFile{"Marlin/Configuration.h", text},
            MarlinFile{"Marlin/Configuration_adv.h",
                       fmt::format("#define CONFIGURATION_ADV_H_VERSION {}\n  #define BUFSIZE 4\n", digits(release))}};
}

/// The result of configure_marlin for files first changed by `edit`.
template <class Edit>
std::string configure_error(Edit edit) {
    auto files = stock(MarlinRelease::v2_1_2);
    edit(files);
    const auto settings = firmware_settings(tower8(MarlinRelease::v2_1_2)).value();
    const auto result = configure_marlin(settings, MarlinRelease::v2_1_2, files[0], files[1]);
    return result ? "no error" : result.error().message;
}

}  // namespace

TEST_CASE("every setting is in the files once per place, and nothing else has changed") {
    for (const MarlinRelease release : {MarlinRelease::v2_1_1, MarlinRelease::v2_1_2, MarlinRelease::v2_1_3}) {
        const auto files = stock(release);
        const auto settings = firmware_settings(tower8(release)).value();
        const auto result = configure_marlin(settings, release, files[0], files[1]);
        REQUIRE_MESSAGE(result, (result ? "" : result.error().message));
        const DefineLines before(files[0].text), after(result->configuration);
        std::set<std::string> listed;
        for (const FirmwareSetting& s : settings) {
            listed.insert(s.name);
            const auto found = after.find(s.name);
            REQUIRE_MESSAGE(found.size() == 1, s.name);
            CHECK_MESSAGE(found[0].active == (s.value != "off"), s.name);
            if (s.value != "on" && s.value != "off") CHECK_MESSAGE(found[0].value == s.value, s.name);
            CHECK_MESSAGE(result->record.find(": " + s.name + " = " + s.value + " (") != std::string::npos, s.name);
        }
        for (const std::string& name : machine::test::marlin_names(release)) {
            if (listed.contains(name) || before.find(name).empty()) continue;
            CHECK_MESSAGE(after.find(name).front().active == before.find(name).front().active, name);
            CHECK_MESSAGE(after.find(name).front().value == before.find(name).front().value, name);
        }
        CHECK(result->added == 9);  // PS_ON, FAN2, the input of A, and three for each of Z2 and I
        CHECK(result->author.empty());
        const std::string bufsize = DefineLines(result->configuration_adv).find("BUFSIZE").front().value;
        CHECK(bufsize == std::to_string(tower8(release).controller.window_lines));
    }
}

TEST_CASE("files that already have all settings are not changed") {
    const MarlinRelease release = MarlinRelease::v2_1_2;
    const auto files = stock(release);
    const auto settings = firmware_settings(tower8(release)).value();
    const ConfiguredMarlin first = configure_marlin(settings, release, files[0], files[1]).value();
    const ConfiguredMarlin again =
        configure_marlin(settings, release, {"a", first.configuration}, {"b", first.configuration_adv}).value();
    CHECK(first.changed > 50);
    CHECK(again.changed == 0);
    CHECK(again.added == 0);
    CHECK(again.configuration == first.configuration);
    CHECK(again.configuration_adv == first.configuration_adv);
}

TEST_CASE("files of another release or program, or without a setting, are refused by name") {
    const auto replace = [](std::string& text, const std::string& old, const std::string& now) {
        const std::size_t at = text.find(old);
        REQUIRE(at != std::string::npos);
        text.replace(at, old.size(), now);
    };
    CHECK(configure_error([](auto&) {}) == "no error");
    CHECK(configure_error([&](auto& f) { replace(f[0].text, "02010201", "02010300"); }) ==
          "Marlin/Configuration.h: CONFIGURATION_H_VERSION 02010300 is of Marlin 2.1.3, the list is for 2.1.2: take "
          "that release, or name this one by --release");
    CHECK(configure_error([&](auto& f) { replace(f[1].text, "02010201", "020008"); }) ==
          "Marlin/Configuration_adv.h: CONFIGURATION_ADV_H_VERSION 020008 is of Marlin 2.0.8, the list is for 2.1.2: "
          "take that release, or name this one by --release");
    CHECK(configure_error([&](auto& f) { replace(f[1].text, "02010201", "soon"); }).find("Marlin unknown") !=
          std::string::npos);
    CHECK(configure_error([](auto& f) { f[0].text = "int main() {}\n"; }) ==
          "Marlin/Configuration.h: has no CONFIGURATION_H_VERSION, which every Configuration.h of Marlin 2 has");
    CHECK(configure_error([](auto& f) { std::swap(f[0].text, f[1].text); }).find("has no CONFIGURATION_H_VERSION") !=
          std::string::npos);
    CHECK(configure_error([&](auto& f) { replace(f[0].text, "USE_WATCHDOG", "USE_A_DOG"); }) ==
          "Marlin/Configuration.h and Marlin/Configuration_adv.h: neither has USE_WATCHDOG: they are not the "
          "configuration files of that release as it came");
    CHECK(configure_error([](auto& f) {
              f[0].text = "#define CONFIGURATION_H_VERSION 02010200\n";
          }).find("more of the list") != std::string::npos);
}

TEST_CASE("a vendor's configuration is recognised by its author") {
    auto files = stock(MarlinRelease::v2_1_2);
    const std::string own = "\"(none, default config)\"";
    files[0].text.replace(files[0].text.find(own), own.size(), "\"(A Vendor, Model 3)\"");
    const auto settings = firmware_settings(tower8(MarlinRelease::v2_1_2)).value();
    CHECK(configure_marlin(settings, MarlinRelease::v2_1_2, files[0], files[1])->author == "\"(A Vendor, Model 3)\"");
}

TEST_CASE("settings are changed in every form that occurs in Marlin's files") {
    // Cases found in the files of 2.1.1, in our own words and numbers: guarded by #ifndef, behind a branch of another
    // setting, in three branches, redefined for a kit, named in a comment, continued on the next line, used as
    // another's value.
    const char* basic =
        "/**\n * An example: #define BAUDRATE 9600\n */\n#pragma once\n#define CONFIGURATION_H_VERSION 02010100\n"
        "#ifndef MOTHERBOARD\n  #define MOTHERBOARD BOARD_SOME\n#endif\n"
        "#define BAUDRATE 250000\n//#define BAUDRATE_2 250000   // overrides BAUDRATE\n"
        "//#define CUSTOM_MACHINE_NAME \"A printer\"\n"
        "#ifdef I_DRIVER_TYPE\n  #define AXIS4_NAME 'A' // :['A', 'B']\n  #define AXIS4_ROTATES\n#endif\n"
        "#if ENABLED(PSU_CONTROL)\n  #define PSU_ACTIVE_STATE LOW      // or 'HIGH'\n"
        "  //#define PSU_DEFAULT_OFF               // not at once\n#endif\n"
        "#define X_BED_SIZE 200\n#define X_MAX_POS X_BED_SIZE\n//#define I_MAX_POS 50\n"
        "//#define NO_MOTION_BEFORE_HOMING // Also see HOME_AFTER_DEACTIVATE\n"
        "                                // for more safety.\n"
        "#define HOMING_FEEDRATE_MM_M { (50*60), (50*60), (4*60) }\n#define TEMP_SENSOR_BED 1\n";
    const char* advanced =
        "#pragma once\n#define CONFIGURATION_ADV_H_VERSION 02010100\n"
        "#if ENABLED(SOME_KIT)\n  #undef TEMP_SENSOR_BED\n  #define TEMP_SENSOR_BED 70\n#endif\n"
        "#if BOTH(CARD, STEPS)\n  #define BLOCK_BUFFER_SIZE  8\n#elif ENABLED(CARD)\n  #define BLOCK_BUFFER_SIZE 32\n"
        "#else\n  #define BLOCK_BUFFER_SIZE 16\n#endif\n"
        "//#define RX_BUFFER_SIZE 1024\n#if RX_BUFFER_SIZE >= 1024\n  //#define SERIAL_XON_XOFF\n#endif\n"
        "//\n// M42 writes to pins\n//\n//#define DIRECT_PIN_CONTROL\n"
        "#define SLOWDOWN\n#if ENABLED(SLOWDOWN)\n  #define SLOWDOWN_DIVISOR 2\n#endif\n";
    const std::vector<FirmwareSetting> settings = {{"MOTHERBOARD", "BOARD_RAMPS_14_EFF", ""},
                                                   {"BAUDRATE", "115200", ""},
                                                   {"CUSTOM_MACHINE_NAME", "\"tower\"", ""},
                                                   {"AXIS4_NAME", "'B'", ""},
                                                   {"AXIS4_ROTATES", "off", ""},
                                                   {"PSU_ACTIVE_STATE", "HIGH", ""},
                                                   {"PSU_DEFAULT_OFF", "off", ""},
                                                   {"X_MAX_POS", "358", ""},
                                                   {"I_MAX_POS", "1460", ""},
                                                   {"NO_MOTION_BEFORE_HOMING", "on", ""},
                                                   {"HOMING_FEEDRATE_MM_M", "{ 480, 1200, 600, 1200 }", ""},
                                                   {"TEMP_SENSOR_BED", "0", ""},
                                                   {"BLOCK_BUFFER_SIZE", "16", ""},
                                                   {"RX_BUFFER_SIZE", "128", ""},
                                                   {"DIRECT_PIN_CONTROL", "on", ""},
                                                   {"SLOWDOWN", "off", ""}};
    const auto made = configure_marlin(settings, MarlinRelease::v2_1_1, {"a", basic}, {"b", advanced});
    REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
    CHECK(made->configuration ==
          "/**\n * An example: #define BAUDRATE 9600\n */\n#pragma once\n#define CONFIGURATION_H_VERSION 02010100\n"
          "#ifndef MOTHERBOARD\n  #define MOTHERBOARD BOARD_RAMPS_14_EFF\n#endif\n"
          "#define BAUDRATE 115200\n//#define BAUDRATE_2 250000   // overrides BAUDRATE\n"
          "#define CUSTOM_MACHINE_NAME \"tower\"\n"
          "#ifdef I_DRIVER_TYPE\n  #define AXIS4_NAME 'B' // :['A', 'B']\n  //#define AXIS4_ROTATES\n#endif\n"
          "#if ENABLED(PSU_CONTROL)\n  #define PSU_ACTIVE_STATE HIGH      // or 'HIGH'\n"
          "  //#define PSU_DEFAULT_OFF               // not at once\n#endif\n"
          "#define X_BED_SIZE 200\n#define X_MAX_POS 358\n#define I_MAX_POS 1460\n"
          "#define NO_MOTION_BEFORE_HOMING // Also see HOME_AFTER_DEACTIVATE\n"
          "                                // for more safety.\n"
          "#define HOMING_FEEDRATE_MM_M { 480, 1200, 600, 1200 }\n#define TEMP_SENSOR_BED 0\n");
    CHECK(
        made->configuration_adv ==
        "#pragma once\n#define CONFIGURATION_ADV_H_VERSION 02010100\n"
        "#if ENABLED(SOME_KIT)\n  #undef TEMP_SENSOR_BED\n  #define TEMP_SENSOR_BED 0\n#endif\n"
        "#if BOTH(CARD, STEPS)\n  #define BLOCK_BUFFER_SIZE  16\n#elif ENABLED(CARD)\n  #define BLOCK_BUFFER_SIZE 16\n"
        "#else\n  #define BLOCK_BUFFER_SIZE 16\n#endif\n"
        "#define RX_BUFFER_SIZE 128\n#if RX_BUFFER_SIZE >= 1024\n  //#define SERIAL_XON_XOFF\n#endif\n"
        "//\n// M42 writes to pins\n//\n#define DIRECT_PIN_CONTROL\n"
        "//#define SLOWDOWN\n#if ENABLED(SLOWDOWN)\n  #define SLOWDOWN_DIVISOR 2\n#endif\n");
    CHECK(made->added == 0);
}
