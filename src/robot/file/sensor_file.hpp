// [[sensor]] of a robot file.
#pragma once

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// Reads [[sensor]] into the robot, whose cables, chambers, markers and objects have been read.
void read_sensors(config::Reader& root, Context& context);

}  // namespace pliant::robot
