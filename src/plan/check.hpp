// Proof-reads G-code before anyone prints it: every command against the dialect and the interlocks of the machine.
#pragma once

#include <string_view>

#include "core/error.hpp"
#include "machine/interlock.hpp"
#include "machine/printer.hpp"

namespace pliant::plan {

/// Fails at the first line that the dialect does not know, that is too long for the wire, that makes a move or shows
/// light the interlocks forbid, or that shows light before the moves are known to be done; the error names the line.
///
/// The text need not be the planner's: what other programs write besides (units, reports, messages, line numbers with
/// their checksums) passes if it does nothing to the machine.
[[nodiscard]] Status check_gcode(std::string_view gcode, const machine::Printer& printer);

/// The machine after the first `lines` lines of a program; errors as above. The printer must outlive the result.
[[nodiscard]] Result<machine::Interlock> replay_gcode(std::string_view gcode, const machine::Printer& printer,
                                                      int lines);

}  // namespace pliant::plan
