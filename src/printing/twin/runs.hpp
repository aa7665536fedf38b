// Layer images as runs of equal pixels: the lit part of a frame is small and mostly uniform.
#pragma once

#include <cstdint>
#include <vector>

#include "printing/job/job.hpp"

namespace pliant::twin {

/// Pixels [begin, end) of one row, all of one value.
struct Run {
    int row = 0;
    int begin = 0, end = 0;
    std::uint16_t value = 0;  ///< grey value, or a sum of grey values

    bool operator==(const Run&) const = default;
};

/// Ordered by row, then column; dark pixels are left out.
using Runs = std::vector<Run>;

/// The lit pixels of an image.
[[nodiscard]] Runs runs_of(const job::Image& image);

/// Pixelwise sum; `width` is that of the frame.
[[nodiscard]] Runs sum_of(const std::vector<Runs>& parts, int width);

/// How many sides of pixels one image has in common with another.
[[nodiscard]] long long common_sides(const Runs& a, const Runs& b);

/// Sum of the grey values: 255 for every fully lit pixel.
[[nodiscard]] long long light_of(const Runs& runs);

}  // namespace pliant::twin
