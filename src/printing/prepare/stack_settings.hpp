// What follows from layer images that were made elsewhere: they are printed as they are.
#pragma once

#include <vector>

#include "printing/machine/printer.hpp"
#include "printing/prepare/drawing.hpp"
#include "printing/prepare/order.hpp"

namespace pliant::prepare {

/// Errors: an option that does not apply to layer images.
[[nodiscard]] Status check_stacks(const Order& order, const Drawing& drawing);

/// Errors: images that were made for pixels of another size, which would give a part that is too large or too small.
[[nodiscard]] Status check_pixels(const Drawing& drawing, const machine::Projector& projector);

/// Layer height, micrometres: --layer, else the height that layer images were made for, else the printer's. Errors:
/// images of another layer height, which would give a part that is too tall or too short.
[[nodiscard]] Result<int> layer_of(const Order& order, const machine::Printer& printer, Drawing& drawing);

/// The tops of the first layers of stacks whose first layer has a height of its own, as PrusaSlicer writes them; empty
/// where it is as high as the others. Micrometres.
[[nodiscard]] Result<std::vector<int>> stacked_tops_um(const Drawing& drawing, int layer_um);

}  // namespace pliant::prepare
