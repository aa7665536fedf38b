// Putting bodies on the platform.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "printing/slice/body.hpp"

namespace pliant::slice {

/// Around all bodies; what bounds() of one of them refuses.
[[nodiscard]] Result<Box3> bounds_of_all(std::span<const Body> bodies);

/// Moves all bodies together so that their bounding box stands on z = 0 and is centred in the image. Returns warnings
/// (a part drawn so far from the origin that its file cannot have kept its details). Errors, with numbers: the part is
/// larger than the image, or has no triangle, or a coordinate is not finite; the bodies are then unchanged.
[[nodiscard]] Result<std::vector<std::string>> place_on_platform(std::span<Body> bodies, const Raster& raster);

}  // namespace pliant::slice
