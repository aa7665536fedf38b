// Leaving a program safely at any line.
#pragma once

#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::plan {

/// G-code that ends a print from this state: pump and fans off, platform up, the vat back in its slot, carriage back.
/// Empty if the platform has not been homed: nothing has moved yet that would need it. `printer` must be that of the
/// interlock.
[[nodiscard]] std::string cancel_program(const machine::Interlock& state, const machine::Printer& printer);

struct Pause {
    std::string begin;  ///< pump off, platform clear of the vat so that nothing cures or sticks
    std::string end;    ///< platform back to its position, pump on again if it was
};

/// Everything off and no motion, not even of the platform: the door is open.
[[nodiscard]] Pause hold_program(const machine::Interlock& state, const machine::Printer& printer);

/// The vat stays where it is.
[[nodiscard]] Pause pause_program(const machine::Interlock& state, const machine::Printer& printer);

}  // namespace pliant::plan
