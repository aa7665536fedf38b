// [material], [mesh] and [[body]] of a robot file: what it is made of.
#pragma once

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// Reads all three into the robot, which also takes from the library what its bodies name there.
void read_bodies(config::Reader& root, Context& context);

}  // namespace pliant::robot
