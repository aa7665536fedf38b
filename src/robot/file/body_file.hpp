// Reads [material], [mesh] and [[body]] of a robot file.
#pragma once

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// Reads all three into the robot, including materials of the library that its bodies name.
void read_bodies(config::Reader& root, Context& context);

}  // namespace pliant::robot
