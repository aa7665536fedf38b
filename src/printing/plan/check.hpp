// Checks G-code before it is printed: every command against the dialect and the interlocks of the machine.
#pragma once

#include <functional>
#include <string_view>

#include "base/core/error.hpp"
#include "printing/machine/gcode.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::plan {

/// Fails at the first line that the dialect does not have, that is too long for the wire, that moves or exposes against
/// the interlocks, or that exposes before the moves are known to be finished; the error names the line.
///
/// The text need not be the planner's: other programs' lines (units, reports, messages, line numbers with checksums)
/// pass if they have no effect on the machine.
[[nodiscard]] Status check_gcode(std::string_view gcode, const machine::Printer& printer);

/// The effect of one accepted line of a program. Valid only during the call of a Watch.
struct Step {
    int line = 0;                                   ///< from 1
    const machine::Command* command = nullptr;      ///< null: a directive
    const machine::Directive* directive = nullptr;  ///< null: a command
    machine::Position from, to;
    double feed_mm_s = 0;                         ///< of a move; 0: as fast as the axes go
    double seconds = 0;                           ///< duration; homing counts as 0
    const machine::Interlock* machine = nullptr;  ///< after the line
};
using Watch = std::function<Status(const Step&)>;

/// The machine after the first `lines` lines of a program; errors as above, and those of `watch`, which is called for
/// every non-empty line. The printer must outlive the result.
[[nodiscard]] Result<machine::Interlock> replay_gcode(std::string_view gcode, const machine::Printer& printer,
                                                      int lines, const Watch& watch = {});

}  // namespace pliant::plan
