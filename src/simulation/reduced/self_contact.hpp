// Where the whole robot touches itself: a reduced model does not know contact.
#pragma once

#include "simulation/stepper/stepper.hpp"

namespace pliant::sim::reduced {

/// True if the robot touches itself where it is. Inputs far from one another are solved in one piece: a robot that
/// would have met itself on the straight way between the two is solved with contact, but may touch nothing at the end.
/// It is without contact again then.
[[nodiscard]] inline bool touches_itself(const Stepper& stepper, RobotState& robot) {
    if (!robot.controls.met) return false;
    if (stepper.system().touches(robot.now.state, robot.controls)) return true;
    robot.controls.met = false;
    return false;
}

}  // namespace pliant::sim::reduced
