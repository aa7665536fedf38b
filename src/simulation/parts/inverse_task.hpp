// The goals of a robot, in terms of its model, and the actuators that may be moved. SI throughout.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/core/vec3.hpp"
#include "robot/description/goal.hpp"

namespace pliant::sim {

using GoalKind = robot::GoalSpec::Kind;

struct Goal {
    std::string name;
    GoalKind kind = GoalKind::position;
    std::vector<std::size_t> markers;  ///< indices
    std::size_t on = 0;                ///< obstacle or support, for forces
    bool sum_of_sizes = false;         ///< for contact forces
    /// (waypoints, or one for all) for a position one point per marker; for a plane a point and its unit normal; a unit
    /// direction; a force, or its magnitude as the first number.
    std::vector<std::vector<Vec3>> wanted;
    double tolerance = 0;  ///< m, rad or N; above zero
    double weight = 1;     ///< above zero
    [[nodiscard]] const std::vector<Vec3>& at(std::size_t waypoint) const {
        return wanted[wanted.size() == 1 ? 0 : waypoint];
    }
};

/// An actuator that may be moved; values as in its target: a ratio, or a quantity in SI.
struct Steered {
    std::size_t actuator = 0;  ///< first the cables, then the chambers
    std::string name;
    double low = 0, high = 0;    ///< low < high
    double rest = 0;             ///< target value without actuation: 1 for ratios, otherwise 0
    std::optional<double> rate;  ///< largest change per waypoint, or per second if times are given; above zero
    double effort_price = 0, change_price = 0;  ///< not negative
};

struct InverseTask {
    std::vector<Goal> goals;      ///< at least one
    std::vector<Steered> inputs;  ///< at least one
    std::vector<double> times;    ///< (waypoints) program time, not decreasing
    bool timed = false;           ///< times were given: rates are per second
    [[nodiscard]] std::size_t waypoints() const { return times.size(); }
};

}  // namespace pliant::sim
