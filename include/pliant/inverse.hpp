/// @file
/// Inverse kinematics: actuator inputs that take the robot to the goals of its file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// An actuator with a range, which inverse(), workspace() and reduce() may vary. Its values are those of the quantity
/// that its `target` in the robot file gives: length ratio, shortening (m) or tension (N) of a cable; volume ratio,
/// volume change (m^3), pressure (Pa above ambient) or gas ratio of a chamber. They are not the values of a Drive.
struct SteeredInput {
    std::string name;  ///< of the cable or chamber
    std::string unit;  ///< SI unit of that quantity; "" for a ratio
    double low = 0;    ///< lower end of its range
    double high = 0;   ///< upper end of its range
};

/// Options of inverse().
struct InverseOptions {
    /// Number of starting points, spread over the ranges, that are tried if the search from rest does not reach the
    /// first waypoint; not negative. Above 0, the nearest of the corners of the ranges and of 16 more points follow.
    int starts = 6;
    /// The result will be written: what InverseResult::write() could not write is refused before the search. Two things
    /// of the same name, which a program would have to name, are an example.
    bool to_write = false;
};

/// Result for one goal at a waypoint.
struct GoalResult {
    std::string name;           ///< as in the robot file
    bool reached = false;       ///< within its tolerance
    double error = 0;           ///< m, rad or N, as `unit` says; the largest over several markers
    std::string unit;           ///< of the error
    std::vector<Point> wanted;  ///< positions; for a plane a point and its normal; a unit direction; a force
    std::vector<Point> got;     ///< positions of its markers; a direction; a force. Of a magnitude: the first number
};

/// Result at one waypoint: the state closest to its goals.
struct Waypoint {
    bool reached = false;             ///< all of its goals are reached
    double time = 0;                  ///< program time, which sets everything that is not steered
    std::vector<GoalResult> goals;    ///< in the order of the robot file
    std::vector<double> inputs;       ///< (InverseResult::inputs()) value of each, in its SteeredInput::unit;
                                      ///< InverseResult::inputs_at() gives them to a Stepper
    std::vector<std::string> limits;  ///< why it is not reached, one sentence each; empty if it is
    StepResult result;                ///< of the equilibrium
    Observation observed;             ///< measurable quantities of the state
    std::vector<Point> positions;     ///< (nodes) m
    int forward_solutions = 0;        ///< equilibria solved for during the search
    double wall_s = 0;                ///< wall time of the search
};

/// Result of inverse(). A value; copies share immutable data.
class PLIANT_API InverseResult {
public:
    /// True if all waypoints were reached.
    [[nodiscard]] bool reached() const;
    /// Why waypoints are missing; empty if none is.
    [[nodiscard]] const std::string& message() const;
    /// Remarks about the search, one sentence each.
    [[nodiscard]] const std::vector<std::string>& notes() const;
    /// The inputs that were varied.
    [[nodiscard]] const std::vector<SteeredInput>& inputs() const;
    /// Number of waypoints in the goals.
    [[nodiscard]] std::size_t waypoints_wanted() const;
    /// Number of waypoints with a result.
    [[nodiscard]] std::size_t waypoint_count() const;
    /// One waypoint, counted from 0.
    /// @throws Failure if the index is out of range.
    [[nodiscard]] Waypoint waypoint(std::size_t index) const;
    /// All inputs of the robot at a waypoint, as Stepper::step() takes them: the values that were found, and for
    /// everything that is not steered those of the program at its time.
    /// @throws Failure if the index is out of range.
    [[nodiscard]] Inputs inputs_at(std::size_t index) const;
    /// Text for people: one line per waypoint, and the active limits of those that were not reached.
    [[nodiscard]] std::string text() const;
    /// All figures, as in inverse.json, whose notes hold `warnings` of write() too.
    [[nodiscard]] std::string json(const std::vector<std::string>& warnings = {}) const;

    /// Writes the folder that `pliant inverse -o` writes, whole or not at all, replacing an older one: program.toml,
    /// which leads through the waypoints, the results of that program, inverse.json and waypoints.csv; also robot.toml
    /// if the robot was given as text. The program of a search that was cancelled leads through the waypoints that were
    /// finished. `enough_pictures` is polled while drawing, by several threads at once, and must not throw; true leaves
    /// out all pictures. Returns warnings, one sentence each: that the program, run from rest, stops early or ends up
    /// elsewhere, or that nothing could be drawn.
    /// @throws Failure if there is no waypoint, the program cannot be read back or meshed, or a file cannot be written;
    /// or when cancelled.
    std::vector<std::string> write(const std::filesystem::path& folder, const Watch& watch = {},
                                   const std::function<bool()>& enough_pictures = {}) const;

    /// @cond
    struct Data;
    explicit InverseResult(std::shared_ptr<const Data> data);

private:
    SharedData<const Data> data_;
    /// @endcond
};

/// Searches for the inputs that take the robot to its goals, one waypoint after the other, each search starting from
/// the previous result. Every answer is an equilibrium. A goal out of reach is not a Failure: the result is the closest
/// state that was found.
/// @throws Failure if the robot has no goals or no actuator with a range, or moves in time, or a goal has a time
/// after the end of the program, or `starts` is negative; or when cancelled before the first waypoint is done.
/// Cancelled later, it returns the waypoints found so far.
[[nodiscard]] PLIANT_API InverseResult inverse(const Model& model, const InverseOptions& options = {},
                                               const Watch& watch = {});

}  // namespace pliant
