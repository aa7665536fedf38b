// What a robot is wanted to reach, tied to its model, and what may be done for it. SI throughout.
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
    std::size_t on = 0;                ///< obstacle or support of a force
    bool sum_of_sizes = false;         ///< of a contact force
    /// (waypoints, or one for all) of a position a point for each marker; of a plane a point and its unit normal; a
    /// unit direction; a force, or its size as the first number.
    std::vector<std::vector<Vec3>> wanted;
    double tolerance = 0;  ///< m, rad or N; above zero
    double weight = 1;     ///< above zero
    [[nodiscard]] const std::vector<Vec3>& at(std::size_t waypoint) const {
        return wanted[wanted.size() == 1 ? 0 : waypoint];
    }
};

/// An actuator that may be moved, in what its target names: a ratio, or a quantity.
struct Steered {
    std::size_t actuator = 0;  ///< first the cables, then the chambers
    std::string name;
    double low = 0, high = 0;    ///< low < high
    double rest = 0;             ///< of the target's value where nothing is driven: 1 of ratios, 0 of all others
    std::optional<double> rate;  ///< largest change per waypoint, or per second where there are times; above zero
    double effort_price = 0, change_price = 0;  ///< not negative
};

struct InverseTask {
    std::vector<Goal> goals;      ///< at least one
    std::vector<Steered> inputs;  ///< at least one
    std::vector<double> times;    ///< (waypoints) of the program, not decreasing
    bool timed = false;           ///< the times were given: rates are per second
    [[nodiscard]] std::size_t waypoints() const { return times.size(); }
};

}  // namespace pliant::sim
