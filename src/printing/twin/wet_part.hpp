// A part as seen by the spray: the cells of a coarse part, hanging on the platform.
#pragma once

#include "printing/machine/printer.hpp"
#include "printing/twin/coarse_part.hpp"
#include "printing/wash/part_cells.hpp"

namespace pliant::twin {

/// All materials together. Empty (no columns) if nothing is solid; at most 80 cells in any direction, and no more than
/// the coarse part has.
[[nodiscard]] wash::PartCells wet_part(const CoarsePart& part, const machine::Projector& projector);

}  // namespace pliant::twin
