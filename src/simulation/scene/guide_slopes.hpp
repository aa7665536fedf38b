// Derivatives of the attachments of a robot's cables and springs with respect to their guide points.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "robot/description/robot.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/model/model.hpp"

namespace pliant::robot {

struct GuideSlope {
    std::string name;  ///< for people, such as: cable "left": point 2
    bool of_spring = false;
    std::size_t path = 0, point = 0;  ///< indices into the description's cables or springs, and their points
    Vec3 rest_m;
    sim::AttachmentSlope slope;
};

/// For all cables, then all springs, in the order of the model's description; includes guide points placed at
/// crossings. `model`: from build_model() for this robot.
[[nodiscard]] Result<std::vector<GuideSlope>> guide_slopes(const Robot& robot, const sim::Model& model);

}  // namespace pliant::robot
