// Proof-reads G-code before anyone prints it: every command against the dialect and the interlocks of the machine.
#pragma once

#include <string_view>

#include "core/error.hpp"
#include "machine/printer.hpp"

namespace pliant::plan {

/// Fails at the first line that the dialect does not know, that is too long for the wire, that makes a move or shows
/// light the interlocks forbid, or that shows light before the moves are known to be done; the error names the line.
[[nodiscard]] Status check_gcode(std::string_view gcode, const machine::Printer& printer);

}  // namespace pliant::plan
