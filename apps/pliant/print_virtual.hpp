// A print on the virtual printer at its own pace: hours of the machine in a second.
#pragma once

#include <string>

#include "base/core/error.hpp"
#include "print_live.hpp"

namespace pliant::app {

/// `report_file`: for the verdict as JSON; "": none. The exit status. Errors: a job that is none, a print that failed
/// or was cancelled. What was asked for of a print that failed (journal, page) is written all the same, of one that was
/// cancelled nothing is.
[[nodiscard]] Result<int> print_virtual(const LiveOptions& options, const std::string& report_file);

}  // namespace pliant::app
