// Notifications about a print for people away from the machine: that it has ended, with which result, or that it waits
// for them.
#pragma once

#include <optional>
#include <string>

#include "base/core/error.hpp"
#include "printing/host/control_types.hpp"

namespace pliant::studio {

struct PrintNews {
    std::string event;  ///< "finished", "failed", "stopped" (the machine has halted), "waiting" (for a person)
    std::string text;   ///< one line
};

/// The notification due to the change between two snapshots of a print; nullopt: none.
[[nodiscard]] std::optional<PrintNews> news_between(const host::Snapshot& before, const host::Snapshot& now);

/// Runs `command` in the shell, with PLIANT_EVENT, PLIANT_TEXT and PLIANT_JOB in its environment, and does not wait for
/// it. Errors: no shell.
[[nodiscard]] Status tell_by_command(const std::string& command, const PrintNews& news, const std::string& job);

}  // namespace pliant::studio
