// Prints on the virtual printer at full speed: hours of machine time in a second.
#pragma once

#include <string>

#include "base/core/error.hpp"
#include "print_live.hpp"

namespace pliant::app {

/// `report_file`: for the verdict as JSON; "": none. Returns the exit status. Errors: an invalid job, a failed or
/// cancelled print. The requested outputs (journal, page) of a failed print are still written, those of a cancelled one
/// are not.
[[nodiscard]] Result<int> print_virtual(const LiveOptions& options, const std::string& report_file);

}  // namespace pliant::app
