// Faults to inject, on the wire and in the machine.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::twin {

/// A fault, which happens once unless stated otherwise. `n` counts from 1.
struct Fault {
    enum class Kind {
        // on the wire
        corrupt_byte,  ///< a bit of the n-th received line flips
        lose_line,     ///< the n-th received line never arrives
        lose_ok,       ///< the n-th `ok` is lost
        lose_resend,   ///< the n-th `Resend:` is lost
        reset,         ///< the controller restarts when the n-th line arrives
        lose_byte,     ///< the n-th received byte never arrives
        flip_byte,     ///< a bit of the n-th received byte flips
        lose_number,   ///< the n-th received line loses its `N…` number, and so is executed unverified
        resend_loop,   ///< from the n-th line on, `amount` valid lines (default 3) are refused
        stall,         ///< the controller is silent and inactive for `amount` seconds (default 30) from the n-th line
                       ///< on
        // behind it
        missed_steps,    ///< the n-th move ends `amount` mm (default 1) short of its target; lasts until homing
        stuck_hook,      ///< the n-th vat to be released from its hooks stays on them permanently
        empty_vat,       ///< slot n holds no resin
        dead_pump,       ///< from its n-th start on the pump delivers nothing
        dark_projector,  ///< the n-th exposure stays dark
        door_open,       ///< half a second into the n-th exposure the door is opened, for `amount` seconds (default 30)
        stuck_switch,    ///< the n-th limit switch of the printer file is always pressed
        dead_switch,     ///< the n-th limit switch of the printer file is never pressed
        weak_magnet,     ///< the n-th vat that the magnet should hold is left behind
        stuck_fork,      ///< the n-th time the retriever's fork should extend it stays in
    };
    Kind kind = Kind::corrupt_byte;
    int n = 1;
    double amount = 0;  ///< 0: the default of the kind
};

/// "lose-line:12", "stall:40:90", "dead-pump"; N and AMOUNT are optional. The error lists the known kinds.
[[nodiscard]] Result<Fault> parse_fault(std::string_view text);

[[nodiscard]] std::string fault_names();

/// As parse_fault() reads it.
[[nodiscard]] std::string fault_text(const Fault& fault);

/// Whether the machine has the part that fails. Errors name fault and part.
[[nodiscard]] Status check_faults(const std::vector<Fault>& faults, const machine::Printer& printer);

}  // namespace pliant::twin
