// The options that say something of two materials where they meet: --interlock and --overlap.
#pragma once

#include "printing/prepare/drawing.hpp"
#include "printing/prepare/order.hpp"
#include "printing/slice/slicer.hpp"

namespace pliant::prepare {

/// Sets teeth and overlaps. A pair holds for all bodies made of its materials, also those with exposures of their own.
/// Errors name the option.
[[nodiscard]] Status set_pairs(const Order& order, const Drawing& drawing, slice::Settings& slicing);

}  // namespace pliant::prepare
