// Programs that are no part of a job: how an interrupted print goes on, and what a person asks of the machine by hand.
#pragma once

#include <string>

#include "base/core/error.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::plan {

/// Where a print was interrupted, and where it shall go on.
struct Interrupted {
    machine::Interlock state;   ///< axes that are not homed may be anywhere; the vat on the hooks is known
    machine::Interlock target;  ///< at the next light
    bool finished = false;      ///< there is no next light: the vat is only put away
    int last_lit_vat = -1;      ///< index of the vat whose resin clings to the part; -1: none
    bool on_hooks = false;      ///< the tower stands half-way on the hooks, nobody knows where
};

/// Platform up (slowly at first, if it is known where it is), every axis homed anew, the right vat brought and the part
/// cleaned if it comes from another, then down to the height of the next light. Errors: there is no safe way.
[[nodiscard]] Result<std::string> resume_program(const Interrupted& interrupted, const machine::Printer& printer);

/// Brings the vat of `slot`, or with 0 puts away the one that is there. Errors: not homed, no such vat.
[[nodiscard]] Result<std::string> vat_program(const machine::Interlock& state, const machine::Printer& printer,
                                              int slot);

/// Cleans the part, or primes the pump, for so long. Errors: not homed, a vat is in the way, too long.
[[nodiscard]] Result<std::string> clean_program(const machine::Interlock& state, const machine::Printer& printer,
                                                double seconds);

}  // namespace pliant::plan
