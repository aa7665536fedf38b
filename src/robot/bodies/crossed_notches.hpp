// The notches that cables cross which ask for gap elements there.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/shapes/solid.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// The empty space of all of them, in length units. `bodies`: every body as it is meshed; `air`: what is drawn as air,
/// which is not filled again. An error names the cable that crosses none, with file and line.
[[nodiscard]] Result<mesh::Solid> crossed_notches(const Robot& robot, const std::vector<mesh::Solid>& bodies,
                                                  const std::vector<mesh::Solid>& air);

}  // namespace pliant::robot
