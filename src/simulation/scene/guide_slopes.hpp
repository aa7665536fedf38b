// How the guide points of a robot's cables and springs are tied to its mesh, as they move.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "robot/description/robot.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/model/model.hpp"

namespace pliant::robot {

struct GuideSlope {
    std::string name;  ///< for people: cable "left": point 2
    bool of_spring = false;
    std::size_t path = 0, point = 0;  ///< of the description's cables or springs
    Vec3 rest_m;
    sim::AttachmentSlope slope;
};

/// Those of cables, then those of springs, in the order of the model's description: with guides at crossings those
/// count, too. `model`: of build_model() for this robot.
[[nodiscard]] Result<std::vector<GuideSlope>> guide_slopes(const Robot& robot, const sim::Model& model);

}  // namespace pliant::robot
