// Reads [contact], [[obstacle]], [[object]] and [fluid] of a robot file.
#pragma once

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// Reads them into the robot; an obstacle or an object alone switches contact on.
void read_contact(config::Reader& root, Context& context);

/// Reads [fluid] into the robot.
void read_fluid(config::Reader& root, Context& context);

}  // namespace pliant::robot
