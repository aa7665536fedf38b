// The notches crossed by cables that request gap elements there.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/shapes/solid.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// The empty space of all of them, in length units. `bodies`: every body as it is meshed; `air`: solids drawn as air,
/// which stay empty. The error names a cable that crosses no notch, with file and line.
[[nodiscard]] Result<mesh::Solid> crossed_notches(const Robot& robot, const std::vector<mesh::Solid>& bodies,
                                                  const std::vector<mesh::Solid>& air);

}  // namespace pliant::robot
