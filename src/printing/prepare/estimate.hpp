// What a print will take, before anything is sliced: for a form that answers while it is filled in.
#pragma once

#include "base/core/progress.hpp"
#include "printing/plan/plan.hpp"
#include "printing/prepare/drawing.hpp"
#include "printing/prepare/order.hpp"

namespace pliant::prepare {

/// The plan of a job whose layers hold every body between its lowest and its highest point, with its volume spread
/// evenly over them: vats, swaps and exposures are those of the sliced job wherever bodies reach through their
/// heights, and resin agrees with it. Left out: supports, hollowing, adaptive layers; bodies inside others count twice.
/// A resin that no vat holds takes a free one. Cost: milliseconds after the drawing is read. Errors: of the order; the
/// part does not fit; layer images, and bodies that are made of slices.
[[nodiscard]] Result<plan::Plan> estimate(Order order, const machine::Printer& printer, Drawing drawing);

}  // namespace pliant::prepare
