// What a controller says of itself, and whether it fits the machine that it is to drive.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// What a board answered to M115, M503, M211, M119 and M113. Lines that are none of theirs are passed over.
struct BoardReport {
    std::string name;                                      ///< of the firmware; "": M115 was not answered
    std::optional<int> extruders;                          ///< EXTRUDER_COUNT
    std::map<std::string, bool> capabilities;              ///< Cap:NAME:1
    std::map<std::string, std::map<char, double>> values;  ///< "M92" -> 'X' -> 80
    std::optional<bool> soft_endstops;                     ///< M211
    std::map<char, double> soft_min, soft_max;             ///< where they are, by letter
    std::vector<std::string> switches;                     ///< "x_min", in lower case
    std::optional<double> busy_every_s;                    ///< M113
};
/// Reads any text; never fails. At most a million characters are looked at.
[[nodiscard]] BoardReport parse_board_report(std::string_view text);

/// What is missing or different, one line each, with what would be right; empty: the board fits the machine.
[[nodiscard]] std::vector<std::string> check_board(const BoardReport& board, const Printer& printer);

}  // namespace pliant::machine
