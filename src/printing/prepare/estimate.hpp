// Estimates a print before slicing: for a form that updates while it is filled in.
#pragma once

#include "base/core/progress.hpp"
#include "printing/plan/plan.hpp"
#include "printing/prepare/drawing.hpp"
#include "printing/prepare/order.hpp"

namespace pliant::prepare {

/// The plan of a job whose layers contain every body between its lowest and highest point, with its volume spread
/// evenly over them. Vats, swaps and exposures equal those of the sliced job if bodies have no gaps in height, and
/// resin is close. Not included: supports, hollowing, adaptive layers; bodies inside others count twice. Cost:
/// milliseconds after the drawing is read. Errors: in the order; a resin that no vat holds, unless the order allows it
/// (Order::any_vat); the part does not fit; layer images, and bodies that are made of slices.
[[nodiscard]] Result<plan::Plan> estimate(Order order, const machine::Printer& printer, Drawing drawing);

}  // namespace pliant::prepare
