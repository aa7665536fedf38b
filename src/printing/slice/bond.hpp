// Interfaces at which two materials are lit in the same place, so that they hold on to each other.
#pragma once

#include <span>
#include <string>

#include "printing/slice/compose.hpp"

namespace pliant::slice {

/// `first` also lights what belongs to `second` within `depth_px` of it in its layer, and what has it right above or
/// below within `layers`. Whose a pixel is does not change: such pixels are lit twice.
struct Bond {
    std::string first, second;  ///< materials
    int depth_px = 0;
    int layers = 0;
};

/// Refuses a material with itself, a depth that is not 0 to 1000 pixels, layers that are not 0 to 1000, and both 0.
[[nodiscard]] Status check(const Bond& bond);

/// Adds the light of one bond (materials of the layer's images), from the pixels that each owns. `around`: the same
/// layer and its neighbours up to Bond::layers, before any bond. What is added counts in MaterialImage::shared_sum.
void add_bond(ComposedLayer& layer, const ComposedLayer& owned, std::span<const ComposedLayer> around, int first,
              int second, int depth_px);

}  // namespace pliant::slice
