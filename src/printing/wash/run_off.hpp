// Solution that runs off: what has hit a part flows down over it, and drips onto what lies below. No constant of its
// own: the volume stays, and solution that runs over a place washes it as if it had hit it.
#pragma once

#include <vector>

#include "printing/wash/spray.hpp"

namespace pliant::wash {

/// Depth of solution that each face gets in a second, in mm, with what runs over it from above. `rates_mm_s` is what
/// the jets bring. Nothing is lost on the way: down a wall straight, over a ledge evenly to all of its edges, off an
/// underside as drops onto the next face below. `faces` must be wet_faces(part).
[[nodiscard]] std::vector<double> with_run_off(const PartCells& part, const std::vector<Face>& faces,
                                               const std::vector<double>& rates_mm_s);

/// What jets and run-off together bring to each face, in mm a second, in the mean over one stroke.
[[nodiscard]] std::vector<double> washed_rates(const PartCells& part, const std::vector<Face>& faces,
                                               const machine::Printer& printer, const Strokes& strokes);

}  // namespace pliant::wash
