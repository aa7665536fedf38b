// What a program does to the machine, command by command: the same commands that go to the controller, tried on the
// interlocks first.
#pragma once

#include <string_view>

#include "base/core/error.hpp"
#include "printing/machine/gcode.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// A machine as far as its commands have been followed. A value; the printer must outlive it.
struct Followed {
    Interlock lock;
    double feed_mm_s = 0;
    double seconds = 0;  ///< that the commands take, homing from where the axes stand

    /// Carries out one command; what moves nothing is passed over. Errors: what the interlocks forbid (the state stays
    /// as it was), letters that are no axis.
    [[nodiscard]] Status command(const Printer& printer, const Command& command);
    [[nodiscard]] Status line(const Printer& printer, std::string_view line);
};

}  // namespace pliant::machine
