// Proof-reads G-code before anyone prints it: every command against the dialect and the interlocks of the machine.
#pragma once

#include <functional>
#include <string_view>

#include "base/core/error.hpp"
#include "printing/machine/gcode.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::plan {

/// Fails at the first line that the dialect does not know, that is too long for the wire, that makes a move or shows
/// light the interlocks forbid, or that shows light before the moves are known to be done; the error names the line.
///
/// The text need not be the planner's: what other programs write besides (units, reports, messages, line numbers with
/// their checksums) passes if it does nothing to the machine.
[[nodiscard]] Status check_gcode(std::string_view gcode, const machine::Printer& printer);

/// What one line of a program did, once it was found allowed. Valid during the call of a Watch only.
struct Step {
    int line = 0;                                   ///< from 1
    const machine::Command* command = nullptr;      ///< null: a directive
    const machine::Directive* directive = nullptr;  ///< null: a command
    machine::Position from, to;
    double feed_mm_s = 0;                         ///< of a move; 0: as fast as the axes go
    double seconds = 0;                           ///< that it takes; homing counts as none
    const machine::Interlock* machine = nullptr;  ///< after it
};
using Watch = std::function<Status(const Step&)>;

/// The machine after the first `lines` lines of a program; errors as above, and those of `watch`, which is told every
/// line that is not empty. The printer must outlive the result.
[[nodiscard]] Result<machine::Interlock> replay_gcode(std::string_view gcode, const machine::Printer& printer,
                                                      int lines, const Watch& watch = {});

}  // namespace pliant::plan
