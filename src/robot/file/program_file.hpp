// The [program] of a robot file: steps, solver, and the keys that say when each actuator, load and support is where.
#pragma once

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// Reads [program] and [[program.key]] into the robot's program and into the curves of what it drives. Precondition:
/// everything that can be driven has been read, and the fluid.
void read_program(config::Reader& root, Context& context);

}  // namespace pliant::robot
