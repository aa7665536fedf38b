// A program as a robot file that stands on another one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robot/description/robot.hpp"

namespace pliant::robot {

/// Where a program is to lead: values of cables and chambers in what their targets name, SI.
struct ProgramPoint {
    double time = 0;  ///< of the robot's own program: where all that is not given here stands
    std::vector<std::pair<std::string, double>> values;
};

/// What program_text() would refuse when these inputs may have any values at points with these times.
[[nodiscard]] Status check_program_names(const Robot& robot, const std::filesystem::path& file,
                                         const std::vector<std::string>& inputs, const std::vector<double>& times);

/// The steps to each of `points` points. With friction the path matters: what was found in one step is repeated in one.
[[nodiscard]] int steps_per_point(const Robot& robot, std::size_t points);

/// What a robot's file has to say for a program.
struct ProgramEntries {
    std::size_t steps = 0;
    std::string duration;  ///< with its unit
    std::string keys;      ///< [[program.key]] for each point
};

/// A program for `robot`, as read from `file`, that is at point k at the time k + 1, s, in `steps_per_point` steps
/// each. An error: what must be given a key has the name of another thing that has one.
[[nodiscard]] Result<ProgramEntries> program_entries(const Robot& robot, const std::filesystem::path& file,
                                                     const std::vector<ProgramPoint>& points, int steps_per_point);

/// `robot`: as read from `file` with `assignments`. Text of a file in `folder` that gives the same robot the program of
/// program_entries(). Errors: as there.
[[nodiscard]] Result<std::string> program_text(const Robot& robot, const std::filesystem::path& file,
                                               const std::vector<std::string>& assignments,
                                               const std::filesystem::path& folder,
                                               const std::vector<ProgramPoint>& points, int steps_per_point,
                                               double tolerance);

}  // namespace pliant::robot
