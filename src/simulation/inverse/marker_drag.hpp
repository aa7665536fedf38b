// Drags a marker: the actuators follow within their ranges, in bounded increments, and every intermediate state is in
// equilibrium.
//
//     MarkerDrag drag(stepper, inputs, marker);
//     while (!drag.lead(robot, wanted_m, progress).settled) show(robot);
#pragma once

#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "simulation/inverse/seeker.hpp"

namespace pliant::sim::inverse {

/// Result of one increment.
struct Led {
    bool settled = false;       ///< at the wanted point, or as near as it can get
    bool reached = false;       ///< at the wanted point
    double error_m = 0;         ///< distance of the marker from the wanted point
    std::vector<Limit> limits;  ///< what stops it, if it settled elsewhere
};

class MarkerDrag {
public:
    /// The stepper must outlive it. Preconditions: at least one input, a marker of the model.
    MarkerDrag(Stepper& stepper, std::vector<Steered> inputs, std::size_t marker);
    MarkerDrag(const MarkerDrag&) = delete;
    MarkerDrag& operator=(const MarkerDrag&) = delete;

    [[nodiscard]] std::size_t marker() const { return task_.goals.front().markers.front(); }
    [[nodiscard]] const std::vector<Steered>& inputs() const { return task_.inputs; }
    /// Moves the robot by one increment towards the state with its marker at the wanted position. Actuators without a
    /// range follow the program at the robot's time. If no progress is possible, the robot is unchanged.
    [[nodiscard]] Led lead(RobotState& robot, const Vec3& wanted_m, const Progress& progress);
    /// (inputs) their values in this state, in the units of their targets.
    [[nodiscard]] std::vector<double> values(const RobotState& robot) const;

private:
    [[nodiscard]] double distance(const RobotState& robot, const Vec3& wanted_m) const;

    const Model* model_;
    InverseTask task_;
    Seeker seeker_;
};

}  // namespace pliant::sim::inverse
