// Lit area of an image, by connected component.
#pragma once

#include "printing/slice/image.hpp"

namespace pliant::job {

/// Components are 4-connected lit pixels. An area is the sum of values / 255, in pixels.
struct ImageAreas {
    int count = 0;  ///< components
    double total_px = 0, largest_px = 0, smallest_px = 0;
    int min_x = 0, min_y = 0, max_x = 0, max_y = 0;  ///< first and last lit column and row; 0 for a dark image
};

[[nodiscard]] ImageAreas areas_of(const slice::Image& image);

}  // namespace pliant::job
