// A controller's report on itself, and whether it fits the machine it is to drive.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// A board's answers to M115, M503, M211, M119 and M113. Other lines are ignored.
struct BoardReport {
    std::string name;                                      ///< of the firmware; "": no answer to M115
    std::optional<int> extruders;                          ///< EXTRUDER_COUNT
    std::map<std::string, bool> capabilities;              ///< Cap:NAME:1
    std::map<std::string, std::map<char, double>> values;  ///< "M92" -> 'X' -> 80
    std::optional<bool> soft_endstops;                     ///< M211
    std::map<char, double> soft_min, soft_max;             ///< limits by axis letter
    std::vector<std::string> switches;                     ///< "x_min", in lower case
    std::optional<double> busy_every_s;                    ///< M113
};
/// Parses any text; never fails. At most a million characters are read.
[[nodiscard]] BoardReport parse_board_report(std::string_view text);

/// Missing or differing settings, one line each, with the right value; empty: the board fits the machine.
[[nodiscard]] std::vector<std::string> check_board(const BoardReport& board, const Printer& printer);

}  // namespace pliant::machine
