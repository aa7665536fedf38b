// The plan's programs as the host takes them.
#pragma once

#include "host/control_types.hpp"
#include "machine/printer.hpp"

namespace pliant::operate {

/// The programs keep a copy of the printer.
[[nodiscard]] host::Programs programs_of(const machine::Printer& printer);

}  // namespace pliant::operate
