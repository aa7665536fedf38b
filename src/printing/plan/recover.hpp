// Programs outside a job: resuming an interrupted print, and manual operations.
#pragma once

#include <string>

#include "base/core/error.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::plan {

/// State of an interrupted print, and the state from which it should continue.
struct Interrupted {
    machine::Interlock state;   ///< axes that are not homed may be anywhere; the vat on the hooks is known
    machine::Interlock target;  ///< at the next exposure
    bool finished = false;      ///< there is no next exposure: only store the vat
    int last_lit_vat = -1;      ///< index of the vat whose resin is on the part; -1: none
    bool on_hooks = false;      ///< the tower is part-way through the stroke of the hooks, position unknown
};

/// Platform up (slowly at first, if its position is known), all axes homed again, the right vat brought and the part
/// cleaned if it comes from another, then down to the height of the next exposure. Errors: there is no safe way.
[[nodiscard]] Result<std::string> resume_program(const Interrupted& interrupted, const machine::Printer& printer);

/// Brings the vat of `slot`; 0 puts the present one away. Errors: not homed, no such vat.
[[nodiscard]] Result<std::string> vat_program(const machine::Interlock& state, const machine::Printer& printer,
                                              int slot);

/// Cleans the part, or primes the pump, for this time. Errors: not homed, a vat is in the way, too long.
[[nodiscard]] Result<std::string> clean_program(const machine::Interlock& state, const machine::Printer& printer,
                                                double seconds);

}  // namespace pliant::plan
