// Queries a connected board.
#pragma once

#include <string>

#include "base/core/error.hpp"

namespace pliant::operate {

/// Opens the port (which resets most boards), waits for the firmware, and returns its answers to M115, M503, M119 and
/// M113. Takes some seconds. Errors: the port. A silent board gives "".
[[nodiscard]] Result<std::string> ask_board(const std::string& port, int baud_rate);

}  // namespace pliant::operate
