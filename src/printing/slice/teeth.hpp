// Interfaces between two materials that grip each other like the fingers of two hands.
#pragma once

#include <string>

#include "printing/slice/compose.hpp"

namespace pliant::slice {

/// In `layers` layers `first` takes what lies within `depth_px` of it from `second`, in the next `layers` the other way
/// round, from the platform on. Where a material is thinner than the depth it is missing in the layers that the other
/// one takes. No pixel gets a second owner, or other light.
struct Teeth {
    std::string first, second;  ///< materials
    int depth_px = 0;
    int layers = 1;
};

/// Refuses a material with itself, a depth that is not 1 to 1000 pixels, layers that are not 1 to 10000.
[[nodiscard]] Status check(const Teeth& teeth);

/// What `taker` takes from `giver` (materials of the layer's images) within `depth_px`.
void take_teeth(ComposedLayer& layer, int taker, int giver, int depth_px);

}  // namespace pliant::slice
