// What a Marlin 2.1 must be built with for a machine, from its printer file, and whether a board says that it was.
// firmware/README.md explains the machine's side; the names are those of Marlin's Configuration.h and _adv.h.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "machine/printer.hpp"

namespace pliant::machine {

struct FirmwareSetting {
    std::string name;    ///< as in Marlin's configuration, upper case
    std::string value;   ///< "on" and "off" define it or take it out
    std::string reason;  ///< one line
};

/// In order, in groups whose first setting has a reason. Errors: a machine that a RAMPS 1.4 with Marlin 2.1 cannot
/// drive: a classic dialect, more motors than five outputs, an axis whose drive is not known, more than 40,000
/// steps a second.
[[nodiscard]] Result<std::vector<FirmwareSetting>> firmware_settings(const Printer& printer);

/// The settings as a file config.ini, which Marlin's own build reads.
[[nodiscard]] Result<std::string> firmware_ini(const Printer& printer);

/// What a board answered to M115, M503, M119 and M113. Lines that are none of theirs are passed over.
struct BoardReport {
    std::string name;                                      ///< of the firmware; "": M115 was not answered
    std::optional<int> extruders;                          ///< EXTRUDER_COUNT
    std::map<std::string, bool> capabilities;              ///< Cap:NAME:1
    std::map<std::string, std::map<char, double>> values;  ///< "M92" -> 'X' -> 80
    std::vector<std::string> switches;                     ///< "x_min", in lower case
    std::optional<double> busy_every_s;                    ///< M113
};
/// Reads any text; never fails. At most a million characters are looked at.
[[nodiscard]] BoardReport parse_board_report(std::string_view text);

/// What is missing or different, one line each, with what would be right; empty: the board fits the machine.
[[nodiscard]] std::vector<std::string> check_board(const BoardReport& board, const Printer& printer);

}  // namespace pliant::machine
