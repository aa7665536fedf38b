// Follows the waypoints of a task, each from the one before.
//
//     Stepper stepper(model, stepper_options(program));
//     const InverseResult result = follow(stepper, task, {}, progress);
//     for (const Waypoint& at : result.waypoints) fmt::print("{} {}\n", at.reached, at.values[0]);
#pragma once

#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "simulation/inverse/seeker.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::sim::inverse {

struct Waypoint {
    bool reached = false;
    std::vector<GoalState> goals;  ///< (goals)
    std::vector<double> values;    ///< (inputs) in what the targets name
    std::vector<Limit> limits;     ///< where not reached
    Step state;                    ///< index 1, 2, ...; time of the program
    Work work;
    double wall_s = 0;
};

struct InverseResult {
    std::vector<Waypoint> waypoints;  ///< fewer than asked for where it was cancelled or there is no state at all
    bool reached = false;             ///< all of them
    bool cancelled = false;
    std::string message;  ///< why waypoints are missing
    std::vector<std::string> notes;
};

struct FollowOptions {
    /// Beginnings spread over the ranges that are tried where the first waypoint is not reached from rest.
    int starts = 6;
};

/// The first waypoint is looked for from rest, every other one from the one before it.
[[nodiscard]] InverseResult follow(Stepper& stepper, const InverseTask& task, const FollowOptions& options,
                                   Progress& progress);

/// A sentence: `flexor is at the lower end of its range`.
[[nodiscard]] std::string text(const Limit& limit);

/// The n-th of points that fill the unit cube evenly, from 0 on (Halton 1960). (size)
[[nodiscard]] Eigen::VectorXd spread_point(int n, Eigen::Index size);

}  // namespace pliant::sim::inverse
