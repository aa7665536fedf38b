// Whether the message of a page has a meaning for a robot.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "studio/requests/message.hpp"
#include "studio/simulate/built_robot.hpp"

namespace pliant::studio {

/// Errors: unknown actuators, kinds and markers, values and times out of range. `rest_measures`: of its actuators.
[[nodiscard]] Status check_message(const Built& built, const std::vector<double>& rest_measures,
                                   const Message& message);

}  // namespace pliant::studio
