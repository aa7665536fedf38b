// What a robot is wanted to reach, and how far its actuators may go for it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::robot {

/// How far an actuator may go, in what its target names: a ratio, or a quantity in SI.
struct SteeringSpec {
    double low = 0, high = 0;
    std::optional<double> rate;  ///< largest change from one waypoint to the next, or per second where goals have times
    double effort_price = 0;     ///< of its tension or pressure, beside that of the others
    double change_price = 0;     ///< of its change since the last waypoint
    int line = 0;
};

/// Waypoints are reached one after the other, all goals together.
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
    bool sum_of_sizes = false;  ///< of a contact force: how hard it presses in all, whatever the directions
    /// (waypoints) of a position a point for each marker, in length units; of a plane a point, in length units, and a
    /// normal; a direction; a force, N, or its size as the first number.
    std::vector<std::vector<Vec3>> wanted;
    std::vector<double> times;  ///< (waypoints) of the program, s; empty: at its end
    double tolerance = 0;       ///< m, rad or N
    double weight = 1;          ///< beside other goals, where not all can be reached
    int line = 0;
};

}  // namespace pliant::robot
