// Shows which resin must be in which vat before a print begins, and asks for confirmation on a terminal.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "command.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::app {

/// Prints slot, resin and amount of every vat of the plan, and `warnings`, to stderr; nothing if quiet.
void show_vats(const plan::Plan& plan, const std::vector<std::string>& warnings, const Output& output);

/// Asks for confirmation if input is a terminal and output is not quiet. Error: the answer is no.
[[nodiscard]] Status ask_for_vats(const Output& output);

}  // namespace pliant::app
