// The G-code of a job, parsed completely before anything moves: commands for the wire and exposures for the projector,
// in order.
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/gcode.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::host {

struct Script {
    std::vector<std::variant<std::string, machine::Expose>> steps;
    std::deque<std::string> stop_commands;  ///< listed by `;@stop`

    [[nodiscard]] const machine::Expose* light(std::size_t step) const {
        return std::get_if<machine::Expose>(&steps[step]);
    }
};

/// Errors name the line.
[[nodiscard]] Result<Script> read_script(std::string_view gcode);

/// Start time of each step, in seconds from the beginning, followed by the end; (steps + 1). Errors: a step that the
/// machine's interlocks forbid, or an exposure longer than it allows.
[[nodiscard]] Result<std::vector<double>> script_times(const Script& script, const machine::Printer& printer);

/// The machine's state before step `step` of an uninterrupted print. Precondition: script_times() found no error. The
/// printer must outlive the result.
[[nodiscard]] machine::Interlock state_before(const Script& script, const machine::Printer& printer, std::size_t step);

}  // namespace pliant::host
