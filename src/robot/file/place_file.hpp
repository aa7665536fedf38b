// [[fixed]], [[plate]], [[load]] and [[marker]] of a robot file: what is tied to a place of the robot.
#pragma once

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// Reads [[fixed]], [[plate]] and [[load]] into the robot; without a support there is a problem.
void read_places(config::Reader& root, Context& context);

/// Reads [[marker]] into the robot.
void read_markers(config::Reader& root, Context& context);

}  // namespace pliant::robot
