// Reads [[goal]], and range, rate and price of actuators.
#pragma once

#include <optional>

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// Unit and limits of `range`, `rate` and `price` of an actuator.
struct SteeredBy {
    std::optional<Dimension> dimension;  ///< empty: dimensionless
    double low = 0, high = 1e300;        ///< limits of a range
    std::string_view possible;           ///< the limits in words: "above 0, at most 1"
    std::string_view effort;             ///< the key of its penalty: "tension" or "pressure"
};

/// Empty if the actuator has no range.
[[nodiscard]] std::optional<SteeringSpec> read_steering(config::Reader& actuator, const SteeredBy& by);

/// The same for an actuator of this name whose target is unclear, which is recorded: a range stands for any.
[[nodiscard]] std::optional<SteeringSpec> skip_steering(config::Reader& actuator, const std::string& name,
                                                        Context& context);

/// Precondition: markers, supports, obstacles and actuators have been read.
void read_goals(config::Reader& root, Context& context);

/// Precondition: the program has been read as well.
void check_goal_times(config::Reader& root, const Robot& robot);

}  // namespace pliant::robot
