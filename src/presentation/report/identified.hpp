// Measured values beside those that were simulated before and after an identification, as plots.
#pragma once

#include <string>
#include <vector>

#include "presentation/draw/plot.hpp"
#include "simulation/identify/identify.hpp"

namespace pliant::report {

struct NamedPlot {
    std::string file;  ///< "measured_mm.png"
    Plot plot;
};

/// One for each unit. Up to three columns are drawn over time: measured as points, simulated before and after as
/// lines; of more, simulated over measured values, which all lie on the diagonal where they agree. Lengths and forces
/// of a column are counted from its first measured value, so that small changes of large coordinates show.
[[nodiscard]] std::vector<NamedPlot> identified_plots(const sim::identify::Identification& result);

}  // namespace pliant::report
