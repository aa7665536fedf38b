// What must be in which vat before a print begins: shown, and asked for on a terminal.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "command.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::app {

/// On stderr: slot, resin and amount of every vat of the plan, and `warnings`; nothing if quiet.
void show_vats(const plan::Plan& plan, const std::vector<std::string>& warnings, const Output& output);

/// Asks whether they are so, where somebody sits at a terminal and the output is not quiet. Error: the answer is no.
[[nodiscard]] Status ask_for_vats(const Output& output);

}  // namespace pliant::app
