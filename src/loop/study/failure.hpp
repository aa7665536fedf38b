// Why a row failed, as its command tells it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace pliant::study {

/// One line from what a command with an exit status other than 0 printed: the error in its JSON; the first waypoint
/// that `inverse` did not reach, with the reasons; the last line on standard error; or the exit status. `output` is
/// discarded JSON if the command printed none.
[[nodiscard]] std::string reason_of_failure(const nlohmann::json& output, const std::string& errors, int exit_status);

}  // namespace pliant::study
