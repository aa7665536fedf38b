// The plan's programs and the printer file's limits in the form that the host needs.
#pragma once

#include "printing/host/control_types.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::operate {

/// The programs keep a copy of the printer.
[[nodiscard]] host::Programs programs_of(const machine::Printer& printer);

/// Limits on lines in flight, from the printer file.
[[nodiscard]] host::LinkOptions link_options(const machine::Controller& controller);

}  // namespace pliant::operate
