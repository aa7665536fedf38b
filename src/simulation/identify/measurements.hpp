// A table of measurements: what was measured at which time of the program, how much it scatters, and what for.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "robot/description/program.hpp"
#include "simulation/identify/channel.hpp"

namespace pliant::sim::identify {

/// Which rows are kept out of the fit, to judge it on.
enum class JudgeOn {
    nothing,       ///< or what the column `use` says
    every_second,  ///< the second row of the table, the fourth...
    second_half,
};

struct MeasuredValue {
    int line = 0;  ///< of the file
    double time = 0;
    std::size_t channel = 0;
    double value = 0;     ///< in the channel's unit
    double scatter = 0;   ///< standard deviation, in that unit; 0: not known
    bool judged = false;  ///< kept out of the fit
};

struct Measurements {
    std::string file;
    std::vector<Channel> channels;      ///< at least one
    std::vector<MeasuredValue> values;  ///< at least one that is not judged
};

/// One row for each instant. The column `time` (of the program) or `step` says which; the columns of find_channel()
/// hold values, NAME_scatter beside NAME its standard deviation, `use` the words fit or judge. Empty cells were not
/// measured. What else steps.csv has is passed over. Errors, with file and line: no such column, no number, a row
/// without a time or with one that the program does not reach, a scatter that is not above zero, nothing to fit to.
[[nodiscard]] Result<Measurements> parse_measurements(std::string_view text, const std::string& file,
                                                      const sim::Description& robot, const robot::Program& program,
                                                      JudgeOn judge);

}  // namespace pliant::sim::identify
