// What a person who is not at the machine wants to hear of a print: that it has ended, how, and that it waits for them.
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

/// What has happened between two looks at a print; nullopt: nothing that anybody must be told.
[[nodiscard]] std::optional<PrintNews> news_between(const host::Snapshot& before, const host::Snapshot& now);

/// Starts `command` by the shell, with PLIANT_EVENT, PLIANT_TEXT and PLIANT_JOB in its environment, and does not wait
/// for it. Errors: no shell.
[[nodiscard]] Status tell_by_command(const std::string& command, const PrintNews& news, const std::string& job);

}  // namespace pliant::studio
