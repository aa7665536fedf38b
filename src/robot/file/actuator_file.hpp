// Reads [[cable]], [[spring]], [[chamber]] and [[gap]] of a robot file.
#pragma once

#include <string_view>

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// What a cable's length at rest may be multiplied with; above 1 it is paid out.
inline constexpr double largest_length_ratio = 10;
inline constexpr std::string_view possible_length_ratios = "above 0, at most 10";

/// Reads them all into the robot. Precondition: [mesh] has been read.
void read_actuators(config::Reader& root, Context& context);

}  // namespace pliant::robot
