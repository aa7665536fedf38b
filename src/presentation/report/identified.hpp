// Plots of measured values and those simulated before and after an identification.
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

/// One plot per unit. Up to three columns are drawn over time: measured as points, simulated before and after as lines;
/// with more columns, simulated over measured values, which lie on the diagonal if they agree. Lengths and forces of a
/// column are relative to its first measured value, so that small changes of large coordinates are visible.
[[nodiscard]] std::vector<NamedPlot> identified_plots(const sim::identify::Identification& result);

}  // namespace pliant::report
