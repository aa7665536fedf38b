// Solves for the waypoints of a task, each starting from the previous one.
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
    std::vector<double> values;    ///< (inputs) in the units of the targets
    std::vector<Limit> limits;     ///< if not reached
    Step state;                    ///< index 1, 2, ...; program time
    Work work;
    double wall_s = 0;

    /// The search was cancelled here before the goals were reached; only the last waypoint of a result can be so.
    [[nodiscard]] bool is_unfinished() const;
};

struct InverseResult {
    std::vector<Waypoint> waypoints;  ///< fewer than requested if cancelled or no state was found
    bool reached = false;             ///< all of them
    bool cancelled = false;
    std::string message;  ///< why waypoints are missing
    std::vector<std::string> notes;
};

struct FollowOptions {
    /// Number of starting points, spread over the ranges, that are tried if the first waypoint is not reached from
    /// rest. Above 0, searches follow from the nearest of the corners of the ranges and of more points.
    int starts = 6;
};

/// Searches for the first waypoint from rest, and for every other one from the one before it.
[[nodiscard]] InverseResult follow(Stepper& stepper, const InverseTask& task, const FollowOptions& options,
                                   Progress& progress);

/// As a sentence: `flexor is at the lower end of its range`.
[[nodiscard]] std::string text(const Limit& limit);
/// Why the waypoint was not reached, one sentence each; empty if it was.
[[nodiscard]] std::vector<std::string> reasons(const Waypoint& waypoint);

/// (size) the n-th point, from 0, of a low-discrepancy sequence in the unit cube (Halton 1960).
[[nodiscard]] Eigen::VectorXd spread_point(int n, Eigen::Index size);

}  // namespace pliant::sim::inverse
