// The [program] of a robot file: steps, solver, and the keys that say when each actuator, load and support is where.
#pragma once

#include "base/core/config.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// Reads [program] and [[program.key]] into the robot's program and into the curves of what it drives. Precondition:
/// everything that can be driven has been read.
void read_program(config::Reader& root, Robot& robot);

}  // namespace pliant::robot
