// Reads [[fixed]], [[plate]], [[load]] and [[marker]] of a robot file: everything attached to a place of the robot.
#pragma once

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// Reads [[fixed]], [[plate]] and [[load]] into the robot; a robot without a support is a problem.
void read_places(config::Reader& root, Context& context);

/// `box`, `plane`, `sphere`, `surface` or `nodes`; a problem unless it is one of them.
[[nodiscard]] Selector read_selector(config::Reader& reader, const Context& context);

/// `axes`: two that are square to each other, of length 1; x and y where the key is missing or wrong.
[[nodiscard]] std::array<Vec3, 2> read_axes(config::Reader& reader);

/// Reads [[marker]] into the robot.
void read_markers(config::Reader& root, Context& context);

}  // namespace pliant::robot
