// The effect of a program on the machine, command by command: the commands that go to the controller are first checked
// against the interlocks.
#pragma once

#include <string_view>

#include "base/core/error.hpp"
#include "printing/machine/gcode.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// A machine's state after the commands so far. A value; the printer must outlive it.
struct Followed {
    Interlock lock;
    double feed_mm_s = 0;
    double seconds = 0;  ///< duration of the commands, including homing from the current positions

    /// Carries out one command; commands without motion are ignored. Errors: what the interlocks forbid (the state then
    /// is unchanged), letters that are not axes.
    [[nodiscard]] Status command(const Printer& printer, const Command& command);
    [[nodiscard]] Status line(const Printer& printer, std::string_view line);
};

}  // namespace pliant::machine
