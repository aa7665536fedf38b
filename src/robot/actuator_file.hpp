// [[cable]], [[chamber]] and [[gap]] of a robot file: what moves it.
#pragma once

#include "robot/reading.hpp"

namespace pliant::robot {

/// Reads all three into the robot. Precondition: [mesh] has been read.
void read_actuators(config::Reader& root, Context& context);

}  // namespace pliant::robot
