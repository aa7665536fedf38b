// The plan's programs and the printer file's limits as the host takes them.
#pragma once

#include "printing/host/control_types.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::operate {

/// The programs keep a copy of the printer.
[[nodiscard]] host::Programs programs_of(const machine::Printer& printer);

/// What the host may have under way, as the printer file says.
[[nodiscard]] host::LinkOptions link_options(const machine::Controller& controller);

}  // namespace pliant::operate
