// A table of measurements: values at times of the program, their scatter and their use.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "robot/description/program.hpp"
#include "simulation/identify/channel.hpp"

namespace pliant::sim::identify {

/// Which rows are held out of the fit for validation.
enum class JudgeOn {
    nothing,       ///< none, except as the column `use` says
    every_second,  ///< the second row of the table, the fourth...
    second_half,
};

struct MeasuredValue {
    int line = 0;  ///< of the file
    double time = 0;
    std::size_t channel = 0;
    double value = 0;     ///< in the channel's unit
    double scatter = 0;   ///< standard deviation, in that unit; 0: unknown
    bool judged = false;  ///< held out of the fit
};

struct Measurements {
    std::string file;
    std::vector<Channel> channels;      ///< at least one
    std::vector<MeasuredValue> values;  ///< at least one that is not held out
    /// Columns of steps.csv about the robot that are no channels: of sensors, objects and joints.
    std::vector<std::string> not_compared{};
};

/// One row per instant. The column `time` (of the program) or `step` gives the instant; the columns of find_channel()
/// hold values, NAME_scatter the standard deviation of NAME, `use` the words fit or judge. Empty cells were not
/// measured. Other columns of steps.csv are ignored. Errors, with file and line: an unknown column, an invalid number,
/// a row without a time or with one outside the program, a scatter that is not above zero, nothing to fit.
[[nodiscard]] Result<Measurements> parse_measurements(std::string_view text, const std::string& file,
                                                      const sim::Description& robot, const robot::Program& program,
                                                      JudgeOn judge);

}  // namespace pliant::sim::identify
