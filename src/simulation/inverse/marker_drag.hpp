// A marker that is led by hand: the actuators follow within their ranges, a bounded piece at a time, and every state on
// the way is at equilibrium.
//
//     MarkerDrag drag(stepper, inputs, marker);
//     while (!drag.lead(robot, wanted_m, progress).settled) show(robot);
#pragma once

#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "simulation/inverse/seeker.hpp"

namespace pliant::sim::inverse {

/// What one piece did.
struct Led {
    bool settled = false;       ///< at the point that is wanted, or as near as it gets
    bool reached = false;       ///< the former
    double error_m = 0;         ///< distance of the marker from there
    std::vector<Limit> limits;  ///< what stops it, where it is settled and not there
};

class MarkerDrag {
public:
    /// The stepper must outlive it. Preconditions: at least one input, a marker of the model.
    MarkerDrag(Stepper& stepper, std::vector<Steered> inputs, std::size_t marker);
    MarkerDrag(const MarkerDrag&) = delete;
    MarkerDrag& operator=(const MarkerDrag&) = delete;

    [[nodiscard]] std::size_t marker() const { return task_.goals.front().markers.front(); }
    [[nodiscard]] const std::vector<Steered>& inputs() const { return task_.inputs; }
    /// Takes the robot a piece nearer to where its marker is wanted. Actuators without a range follow the program at
    /// the robot's time. Where there is no way on the robot stays as it is.
    [[nodiscard]] Led lead(RobotState& robot, const Vec3& wanted_m, const Progress& progress);
    /// (inputs) what they are in this state, in what their targets name.
    [[nodiscard]] std::vector<double> values(const RobotState& robot) const;

private:
    [[nodiscard]] double distance(const RobotState& robot, const Vec3& wanted_m) const;

    const Model* model_;
    InverseTask task_;
    Seeker seeker_;
};

}  // namespace pliant::sim::inverse
