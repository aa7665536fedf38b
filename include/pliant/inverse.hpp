/// @file
/// Inverse kinematics: what to pull so that the robot meets the goals of its file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// An actuator with a range: what inverse() and workspace() may move.
struct SteeredInput {
    std::string name;  ///< of the cable or chamber
    std::string unit;  ///< SI, of what its target names; "" of a ratio
    double low = 0;    ///< of its range
    double high = 0;   ///< of its range
};

/// How inverse() searches.
struct InverseOptions {
    /// Beginnings spread over the ranges that are tried where the way from rest does not reach the first waypoint.
    int starts = 6;
};

/// How one goal fares at a waypoint.
struct GoalResult {
    std::string name;           ///< as in the robot file
    bool reached = false;       ///< within its tolerance
    double error = 0;           ///< m, rad or N, as `unit` says; of several markers the largest
    std::string unit;           ///< of the error
    std::vector<Point> wanted;  ///< places; of a plane a point and its normal; a unit direction; a force
    std::vector<Point> got;     ///< places of its markers; a direction; a force. A size is the first number.
};

/// A waypoint, as far as the robot got to it.
struct Waypoint {
    bool reached = false;             ///< all of its goals
    double time = 0;                  ///< of the robot's program: where all that is not steered stands
    std::vector<GoalResult> goals;    ///< in the order of the robot file
    std::vector<double> inputs;       ///< (InverseResult::inputs()) SI
    std::vector<std::string> limits;  ///< where not reached: what stops it, a sentence each
    StepResult result;                ///< of the equilibrium
    Observation observed;             ///< what it is like
    std::vector<Point> positions;     ///< (nodes) m
    int forward_solutions = 0;        ///< equilibria that were solved for on the way
    double wall_s = 0;                ///< wall time of the search
};

/// What came of the goals. A value; copies share what never changes.
class PLIANT_API InverseResult {
public:
    /// All waypoints.
    [[nodiscard]] bool reached() const;
    /// Why waypoints are missing; empty where none is.
    [[nodiscard]] const std::string& message() const;
    /// What is worth knowing about the search, a sentence each.
    [[nodiscard]] const std::vector<std::string>& notes() const;
    /// What was moved.
    [[nodiscard]] const std::vector<SteeredInput>& inputs() const;
    /// Waypoints of the goals.
    [[nodiscard]] std::size_t waypoints_wanted() const;
    /// Waypoints that there is a state for.
    [[nodiscard]] std::size_t waypoint_count() const;
    /// A waypoint, from 0.
    /// @throws Failure where there is none of that index.
    [[nodiscard]] Waypoint waypoint(std::size_t index) const;
    /// For people: a line for each waypoint, and what stops those that are not reached.
    [[nodiscard]] std::string text() const;
    /// All figures, as in inverse.json.
    [[nodiscard]] std::string json() const;

    /// Writes the folder that `pliant inverse -o` writes, whole or not at all, in place of an older one: program.toml,
    /// which leads through the waypoints, its results, inverse.json and waypoints.csv. Gives warnings where that
    /// program, run from rest, leads elsewhere. Of a robot that was given as text robot.toml is written, too.
    /// @throws Failure where there is no waypoint, of the program, of the disk; cancelled.
    std::vector<std::string> write(const std::filesystem::path& folder, const Watch& watch = {}) const;

    /// @cond
    struct Data;
    explicit InverseResult(std::shared_ptr<const Data> data);

private:
    std::shared_ptr<const Data> data_;
    /// @endcond
};

/// Looks for the inputs that take the robot to its goals, waypoint by waypoint, each from the one before; every answer
/// is an equilibrium. What cannot be reached ends as near as it gets, and is no Failure.
/// @throws Failure where the robot has no goals or no actuator with a range, or moves in time; cancelled before the
/// first waypoint was done.
[[nodiscard]] PLIANT_API InverseResult inverse(const Model& model, const InverseOptions& options = {},
                                               const Watch& watch = {});

}  // namespace pliant
