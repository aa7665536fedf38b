// Reads [[cable]], [[spring]], [[chamber]] and [[gap]] of a robot file.
#pragma once

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// Reads them all into the robot. Precondition: [mesh] has been read.
void read_actuators(config::Reader& root, Context& context);

}  // namespace pliant::robot
