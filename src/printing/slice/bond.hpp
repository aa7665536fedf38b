// Interfaces where two materials are exposed in the same place, so that they bond.
#pragma once

#include <span>
#include <string>

#include "printing/slice/compose.hpp"

namespace pliant::slice {

/// `first` is also exposed where `second` is within `depth_px` of it in the same layer, or directly above or below it
/// within `layers`. Pixel ownership does not change: such pixels are exposed twice.
struct Bond {
    std::string first, second;  ///< materials
    int depth_px = 0;
    int layers = 0;
    std::string named{};  ///< the pair that it belongs to, in messages; empty: its own materials
};

/// Errors: a material with itself, a depth outside 0 to 1000 pixels, layers outside 0 to 1000, and both 0.
[[nodiscard]] Status check(const Bond& bond);

/// Adds the exposure of one bond (materials of the layer's images), from the pixels that each owns. `around`: the same
/// layer and its neighbours up to Bond::layers, before any bond. The added area is counted in
/// MaterialImage::shared_sum. Returns whether the two meet here, so that something is exposed twice.
bool add_bond(ComposedLayer& layer, const ComposedLayer& owned, std::span<const ComposedLayer> around, int first,
              int second, int depth_px);

}  // namespace pliant::slice
