// The plan of a print as one picture: where the time goes, one change of vats device by device (thesis, Fig. 4.7), and
// which vat prints which layers. The only part of this folder that knows the printing wing.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/timeline.hpp"

namespace pliant::report {

/// A PNG file of 1600 x 1000 pixels. `swap` is plan::longest_swap(); if it has no phases, its panel says so.
[[nodiscard]] Result<std::string> plan_picture(const plan::Plan& plan, const plan::SwapTimeline& swap);

/// The ranges of consecutive layers [first, last] printed from a vat (an index into Printer::vats).
struct LayerRun {
    int first = 0;
    int last = 0;
    bool operator==(const LayerRun&) const = default;
};
[[nodiscard]] std::vector<LayerRun> layer_runs(const plan::Plan& plan, int vat);

}  // namespace pliant::report
