// [contact] and [[obstacle]] of a robot file.
#pragma once

#include "core/config.hpp"
#include "mesh/solid.hpp"
#include "robot/robot.hpp"

namespace pliant::robot {

/// Reads both into the robot; an obstacle alone switches contact on. `shapes`: what `use` may name.
void read_contact(config::Reader& root, Robot& robot, const mesh::NamedShapes& shapes, config::Problems& problems);

}  // namespace pliant::robot
