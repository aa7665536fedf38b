// Prints on the virtual printer at full speed: hours of machine time in a second.
#pragma once

#include "base/core/error.hpp"
#include "print_live.hpp"

namespace pliant::app {

/// Returns the exit status. Errors: an invalid job, a journal file that must not be replaced, a failed or cancelled
/// print. The requested outputs (journal, page) of a failed print are still written, those of a cancelled one are not.
[[nodiscard]] Result<int> print_virtual(const LiveOptions& options);

}  // namespace pliant::app
