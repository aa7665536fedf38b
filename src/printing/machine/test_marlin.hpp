// Names and rules of three releases of Marlin, as far as our settings use them: taken from their Configuration.h,
// Configuration_adv.h and SanityCheck.h (2.1.3: the branch bugfix-2.1.x of 2024, whose Changes.h rejects removed
// names), and written down in our own words, independent of the code that writes the settings.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "printing/machine/firmware.hpp"
#include "printing/machine/marlin_release.hpp"

namespace pliant::machine::test {

/// The names that a release knows, among all that may be in a list: of its two configuration files, and of pins that
/// can be set there. Any other name is an error in that release, or has no effect.
inline std::set<std::string> marlin_names(MarlinRelease release) {
    std::set<std::string> names = {
        // Configuration.h
        "MOTHERBOARD", "SERIAL_PORT", "BAUDRATE", "CUSTOM_MACHINE_NAME", "Z2_DRIVER_TYPE", "EXTRUDERS", "TEMP_SENSOR_0",
        "TEMP_SENSOR_BED", "PSU_CONTROL", "PSU_ACTIVE_STATE", "PSU_DEFAULT_OFF", "ENDSTOPPULLUPS",
        "DEFAULT_AXIS_STEPS_PER_UNIT", "DEFAULT_MAX_FEEDRATE", "DEFAULT_MAX_ACCELERATION", "DEFAULT_ACCELERATION",
        "DEFAULT_TRAVEL_ACCELERATION", "CLASSIC_JERK", "Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN", "NO_MOTION_BEFORE_HOMING",
        "X_BED_SIZE", "Y_BED_SIZE", "MIN_SOFTWARE_ENDSTOPS", "MAX_SOFTWARE_ENDSTOPS", "FIL_RUNOUT_STATE",
        "HOMING_FEEDRATE_MM_M", "VALIDATE_HOMING_ENDSTOPS", "EEPROM_SETTINGS", "HOST_KEEPALIVE_FEATURE",
        "DEFAULT_KEEPALIVE_INTERVAL", "SDSUPPORT",
        // Configuration_adv.h
        "HOMING_BUMP_MM", "HOMING_BUMP_DIVISOR", "AXIS_RELATIVE_MODES", "SLOWDOWN", "USE_WATCHDOG", "BLOCK_BUFFER_SIZE",
        "BUFSIZE", "RX_BUFFER_SIZE", "EMERGENCY_PARSER", "ADVANCED_OK", "HOST_ACTION_COMMANDS",
        "EXTENDED_CAPABILITIES_REPORT", "DIRECT_PIN_CONTROL",
        // pins
        "FAN2_PIN", "PS_ON_PIN"};
    const bool newer = release == MarlinRelease::v2_1_3;
    names.insert(newer ? "DEFAULT_STEPPER_TIMEOUT_SEC" : "DEFAULT_STEPPER_DEACTIVE_TIME");
    names.insert(newer ? "Z_MIN_PROBE_ENDSTOP_HIT_STATE" : "Z_MIN_PROBE_ENDSTOP_INVERTING");
    for (const std::string axis : {"X", "Y", "Z", "I", "J", "K"}) {
        for (const char* name : {"{}_DRIVER_TYPE", "{}_ENABLE_ON", "INVERT_{}_DIR", "{}_HOME_DIR", "{}_MIN_POS",
                                 "{}_MAX_POS", "DEFAULT_{}JERK"})
            names.insert(fmt::format(fmt::runtime(name), axis));
        for (const std::string end : {"MIN", "MAX"}) {
            names.insert(axis + "_" + end + (newer ? "_ENDSTOP_HIT_STATE" : "_ENDSTOP_INVERTING"));
            if (!newer) names.insert("USE_" + axis + end + "_PLUG");
            if (axis > "H" && axis < "L") names.insert(axis + "_" + end + "_PIN");
        }
        if (newer) names.insert(axis + "_SAFETY_STOP");
    }
    for (const std::string motor : {"Z2", "I", "J", "K"}) {
        for (const char* pin : {"_STEP_PIN", "_DIR_PIN", "_ENABLE_PIN"}) names.insert(motor + pin);
    }
    for (const std::string n : {"4", "5", "6"}) {
        names.insert("AXIS" + n + "_NAME");
        names.insert("AXIS" + n + "_ROTATES");
    }
    return names;
}

/// Checks a list against the rules of a release; one line per violation.
class MarlinRules {
public:
    MarlinRules(const std::vector<FirmwareSetting>& list, MarlinRelease release) : release_(release) {
        const std::set<std::string> names = marlin_names(release);
        for (const FirmwareSetting& s : list) {
            if (!names.contains(s.name)) problem("{} is not known", s.name);
            if (!values_.emplace(s.name, s.value).second) problem("{} stands twice", s.name);
        }
        axes_ = {"X", "Y", "Z"};
        for (const std::string axis : {"I", "J", "K"}) {
            if (has(axis + "_DRIVER_TYPE")) axes_.push_back(axis);
        }
    }

    std::vector<std::string> problems() {
        check_extra_axes();
        check_rows();
        check_plugs();
        check_pins();
        for (const char* size : {"BLOCK_BUFFER_SIZE", "RX_BUFFER_SIZE"}) {
            const int n = std::atoi(value(size).c_str());
            if (n < 2 || (n & (n - 1)) != 0) problem("{} must be a power of 2", size);
        }
        if (value("EXTRUDERS") == "0" && value("TEMP_SENSOR_0") != "0") problem("TEMP_SENSOR_0 without an extruder");
        if (value("PSU_CONTROL") == "on") need("PSU_ACTIVE_STATE", "PSU_CONTROL");
        if (value("CUSTOM_MACHINE_NAME").find_first_of("\\%#;$") != std::string::npos)
            problem("CUSTOM_MACHINE_NAME: {} is not plain", value("CUSTOM_MACHINE_NAME"));
        return problems_;
    }

private:
    template <class... Words>
    void problem(fmt::format_string<Words...> text, Words&&... words) {
        problems_.push_back(fmt::format(text, std::forward<Words>(words)...));
    }
    [[nodiscard]] bool has(const std::string& name) const { return values_.contains(name); }
    [[nodiscard]] std::string value(const std::string& name) const { return has(name) ? values_.at(name) : ""; }
    void need(const std::string& name, const std::string& by) {
        if (!has(name)) problem("{} is required with {}", name, by);
    }

    void check_extra_axes() {
        std::set<std::string> letters;
        for (std::size_t i = 3; i < axes_.size(); ++i) {
            const std::string& axis = axes_[i];
            for (const std::string& name : {axis + "_ENABLE_ON", "INVERT_" + axis + "_DIR", axis + "_HOME_DIR",
                                            axis + "_MIN_POS", axis + "_MAX_POS", axis + "_STEP_PIN", axis + "_DIR_PIN",
                                            axis + "_ENABLE_PIN", fmt::format("AXIS{}_NAME", i + 1)})
                need(name, "the axis " + axis);
            if (!letters.insert(value(fmt::format("AXIS{}_NAME", i + 1))).second)
                problem("AXIS{}_NAME must be unique", i + 1);
            if (i > 3 && value(fmt::format("AXIS{}_ROTATES", i + 1)) == "on" &&
                value(fmt::format("AXIS{}_ROTATES", i)) != "on")
                problem("AXIS{}_ROTATES requires AXIS{}_ROTATES", i + 1, i);
            if (i == 3 && axes_[3] != "I") problem("{} without an axis I", axis);
        }
    }

    /// "{ a, b }" must have an entry for every axis and no more: there is no extruder.
    void check_rows() {
        const std::map<std::string, double> least = {
            {"AXIS_RELATIVE_MODES", -1},        {"DEFAULT_AXIS_STEPS_PER_UNIT", 1e-9}, {"DEFAULT_MAX_FEEDRATE", 1e-9},
            {"DEFAULT_MAX_ACCELERATION", 1e-9}, {"HOMING_FEEDRATE_MM_M", 1e-9},        {"HOMING_BUMP_MM", 0},
            {"HOMING_BUMP_DIVISOR", 1}};
        for (const auto& [name, low] : least) {
            need(name, "EXTRUDERS 0");
            const std::string row = value(name);
            if (row.empty()) continue;
            const auto count = static_cast<std::size_t>(std::count(row.begin(), row.end(), ',')) + 1;
            if (count != axes_.size()) problem("{} has {} entries for {} axes", name, count, axes_.size());
            for (std::size_t at = row.find_first_of("{,"); at != std::string::npos && low >= 0;
                 at = row.find(',', at + 1)) {
                if (std::atof(row.c_str() + at + 1) < low) problem("{}: {} is too small", name, row);
            }
        }
    }

    void check_plugs() {
        for (const std::string& axis : axes_) {
            const std::string end = value(axis + "_HOME_DIR") == "1" ? "MAX" : "MIN";
            if (release_ != MarlinRelease::v2_1_3) {
                if (value("USE_" + axis + end + "_PLUG") != "on") problem("{} homes to {} without a plug", axis, end);
                continue;
            }
            const std::string level = value(axis + "_" + end + "_ENDSTOP_HIT_STATE");
            if (level != "HIGH" && level != "LOW") problem("{} homes to {} at no level", axis, end);
            // It is on by default and makes the firmware check Z_MIN, where nothing is connected.
            if (axis == "Z" && end == "MAX" && !has("Z_SAFETY_STOP") &&
                value("Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN") != "off")
                problem("Z_MIN is looked at, as if a probe were there");
        }
    }

    /// RAMPS 1.4: the dedicated pins of X, Y and Z, and pins that no two settings may share.
    void check_pins() {
        std::map<std::string, std::string> owner = {
            {"54", "X"}, {"55", "X"}, {"38", "X"},   {"60", "Y"},  {"61", "Y"},     {"56", "Y"},    {"46", "Z"},
            {"48", "Z"}, {"62", "Z"}, {"8", "FAN1"}, {"9", "FAN"}, {"0", "serial"}, {"1", "serial"}};
        const std::map<std::string, std::string> inputs = {{"X_MIN", "3"},  {"X_MAX", "2"},  {"Y_MIN", "14"},
                                                           {"Y_MAX", "15"}, {"Z_MIN", "18"}, {"Z_MAX", "19"}};
        for (const auto& [input, pin] : inputs) {
            const std::string axis = input.substr(0, 1), end = input.substr(2);
            const bool homes = (value(axis + "_HOME_DIR") == "1") == (end == "MAX");
            const bool used = release_ == MarlinRelease::v2_1_3 ? homes || value(axis + "_SAFETY_STOP") == "on"
                                                                : value("USE_" + axis + end + "_PLUG") == "on";
            if (used) owner.emplace(pin, input);
        }
        for (const auto& [name, pin] : values_) {
            if (!name.ends_with("_PIN") || pin == "off") continue;
            const auto [other, is_new] = owner.emplace(pin, name);
            if (!is_new) problem("{} is pin {}, which {} has", name, pin, other->second);
        }
    }

    MarlinRelease release_;
    std::map<std::string, std::string> values_;
    std::vector<std::string> axes_;
    std::vector<std::string> problems_;
};

inline std::vector<std::string> marlin_problems(const std::vector<FirmwareSetting>& list, MarlinRelease release) {
    return MarlinRules(list, release).problems();
}

}  // namespace pliant::machine::test
