// [[goal]]; and range, rate and price of actuators.
#pragma once

#include <optional>

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// What `range`, `rate` and `price` of an actuator are written in, and what is possible.
struct SteeredBy {
    std::optional<Dimension> dimension;  ///< none: a plain number
    double low = 0, high = 1e300;        ///< of a range
    std::string_view possible;           ///< in words: "above 0, at most 1"
    std::string_view effort;             ///< the price's key: "tension" or "pressure"
};

/// Nothing where the actuator has no range.
[[nodiscard]] std::optional<SteeringSpec> read_steering(config::Reader& actuator, const SteeredBy& by);

/// Precondition: markers, supports, obstacles and actuators have been read.
void read_goals(config::Reader& root, Context& context);

}  // namespace pliant::robot
