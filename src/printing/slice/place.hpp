// Placing bodies on the platform.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "printing/slice/body.hpp"

namespace pliant::slice {

/// Bounds of all bodies; errors of bounds() for any of them.
[[nodiscard]] Result<Box3> bounds_of_all(std::span<const Body> bodies);

/// Moves all bodies together so that their bounding box rests on z = 0 and is centred in the image. Returns warnings (a
/// part drawn so far from the origin that its file cannot hold its details). Errors, with numbers: the part is larger
/// than the image, has no triangle, or a coordinate is not finite; the bodies are then unchanged.
[[nodiscard]] Result<std::vector<std::string>> place_on_platform(std::span<Body> bodies, const Raster& raster);

}  // namespace pliant::slice
