// Parts of a robot that nothing uses.
#pragma once

#include <string>
#include <vector>

#include "robot/description/robot.hpp"

namespace pliant::robot {

/// A remark for each material that no body is made of.
[[nodiscard]] std::vector<std::string> unused_materials(const Robot& robot);

}  // namespace pliant::robot
