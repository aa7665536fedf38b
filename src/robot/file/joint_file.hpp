// Reads [[joint]].
#pragma once

#include "robot/file/reading.hpp"

namespace pliant::robot {

/// Precondition: bodies, plates and objects have been read, which joints name.
void read_joints(config::Reader& root, Context& context);

}  // namespace pliant::robot
