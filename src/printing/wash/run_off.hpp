// Run-off: solution that has hit a part flows down over it and drips onto what is below. It needs no constant of its
// own: volume is conserved, and solution that flows over a place washes it as if it had hit it.
#pragma once

#include <vector>

#include "printing/wash/spray.hpp"

namespace pliant::wash {

/// Depth of solution that each face gets per second, in mm, including what flows over it from above. `rates_mm_s`: from
/// the jets. Volume is conserved: it flows straight down a wall, over a ledge evenly to all of its edges, and drips off
/// an underside onto the next face below. `faces` must be wet_faces(part).
[[nodiscard]] std::vector<double> with_run_off(const PartCells& part, const std::vector<Face>& faces,
                                               const std::vector<double>& rates_mm_s);

/// The sum of jets and run-off for each face, in mm per second, averaged over one stroke.
[[nodiscard]] std::vector<double> washed_rates(const PartCells& part, const std::vector<Face>& faces,
                                               const machine::Printer& printer, const Strokes& strokes);

}  // namespace pliant::wash
