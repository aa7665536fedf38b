// [contact] and [[obstacle]] of a robot file.
#pragma once

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// Reads both into the robot; an obstacle alone switches contact on.
void read_contact(config::Reader& root, Context& context);

}  // namespace pliant::robot
