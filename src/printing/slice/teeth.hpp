// Interlocking interfaces between two materials, like finger joints.
#pragma once

#include <string>

#include "printing/slice/compose.hpp"

namespace pliant::slice {

/// From the platform up, `first` takes what is within `depth_px` of it from `second` for `layers` layers, then the
/// other way round, alternating. Where a material is thinner than the depth it is missing in the layers that the other
/// one takes. No pixel gets a second owner, or different light.
struct Teeth {
    std::string first, second;  ///< materials
    int depth_px = 0;
    int layers = 1;
    std::string named{};  ///< the pair that it belongs to, in messages; empty: its own materials
};

/// Errors: a material with itself, a depth outside 1 to 1000 pixels, layers outside 1 to 10000.
[[nodiscard]] Status check(const Teeth& teeth);

/// Moves to `taker` what is within `depth_px` of it in `giver` (materials of the layer's images). Returns whether there
/// is anything.
bool take_teeth(ComposedLayer& layer, int taker, int giver, int depth_px);

}  // namespace pliant::slice
