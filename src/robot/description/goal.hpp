// The goals of a robot, and how far its actuators may go to reach them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::robot {

/// Range of an actuator, in the quantity of its target: a ratio, or a value in SI.
struct SteeringSpec {
    double low = 0, high = 0;
    std::optional<double> rate;  ///< largest change from one waypoint to the next, or per second if goals have times
    double effort_price = 0;     ///< penalty weight of its tension or pressure, relative to other actuators
    double change_price = 0;     ///< penalty weight of its change since the last waypoint
    int line = 0;
};

/// Waypoints are reached one after the other, all goals simultaneously.
struct GoalSpec {
    enum class Kind {
        position,       ///< of one marker, or of several: a shape
        plane,          ///< on which a marker is wanted
        direction,      ///< from one marker to another
        contact_force,  ///< of an obstacle on the robot
        support_force,  ///< of a support on the robot
    };
    std::string name;
    Kind kind = Kind::position;
    std::vector<std::string> markers;
    std::string on;             ///< the obstacle or support of a force
    bool sum_of_sizes = false;  ///< for a contact force: the sum of magnitudes, whatever the directions
    /// (waypoints) for a position one point per marker, in length units; for a plane a point, in length units, and a
    /// normal; a direction; a force, N, or its magnitude as the first number.
    std::vector<std::vector<Vec3>> wanted;
    std::vector<double> times;       ///< (waypoints) program time, s; empty: at its end
    double tolerance = 0;            ///< m, rad or N
    bool default_tolerance = false;  ///< a tenth of the length unit, because the file gives none
    double weight = 1;               ///< relative to other goals, if not all can be reached
    int line = 0;
};

/// What is wrong with a goal that has a time after the end of the program, without the goal's kind and name and what
/// to do; empty if it has none.
[[nodiscard]] std::string late_time(const GoalSpec& goal, double duration);

}  // namespace pliant::robot
