// How to leave a program in the middle without harm, whatever line it is at.
#pragma once

#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::plan {

/// G-code that ends a print from this state: pump and fans off, platform up, the vat back in its slot, carriage back.
/// Empty if the platform has not been homed: then nothing has moved that would have to be put right. `printer` must be
/// that of the interlock.
[[nodiscard]] std::string cancel_program(const machine::Interlock& state, const machine::Printer& printer);

struct Pause {
    std::string begin;  ///< pump off, platform clear of the vat so that nothing cures or sticks
    std::string end;    ///< the platform back to where it was, the pump on again if it ran
};

/// Everything off and nothing moves, not even the platform: the door is open.
[[nodiscard]] Pause hold_program(const machine::Interlock& state, const machine::Printer& printer);

/// The vat stays where it is.
[[nodiscard]] Pause pause_program(const machine::Interlock& state, const machine::Printer& printer);

}  // namespace pliant::plan
