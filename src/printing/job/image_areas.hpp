// What an image lights, piece by piece.
#pragma once

#include "printing/slice/image.hpp"

namespace pliant::job {

/// Pieces of lit pixels hang together through the sides of pixels. An area is the sum of values / 255, in pixels.
struct ImageAreas {
    int count = 0;  ///< pieces
    double total_px = 0, largest_px = 0, smallest_px = 0;
    int min_x = 0, min_y = 0, max_x = 0, max_y = 0;  ///< first and last lit column and row; 0 of a dark image
};

[[nodiscard]] ImageAreas areas_of(const slice::Image& image);

}  // namespace pliant::job
