// A part as the spray meets it: the cells of a coarse part, where it hangs on the platform.
#pragma once

#include "printing/machine/printer.hpp"
#include "printing/twin/coarse_part.hpp"
#include "printing/wash/part_cells.hpp"

namespace pliant::twin {

/// Whatever its materials. Empty (no columns) if nothing is solid; at most 80 cells in any direction, and at most so
/// many as the coarse part has.
[[nodiscard]] wash::PartCells wet_part(const CoarsePart& part, const machine::Projector& projector);

}  // namespace pliant::twin
