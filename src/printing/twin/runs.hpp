// Layer images as runs of equal pixels: what is lit is a small part of a frame, and long runs of it are of one value.
#pragma once

#include <cstdint>
#include <vector>

#include "printing/job/job.hpp"

namespace pliant::twin {

/// Pixels [begin, end) of one row, all of one value.
struct Run {
    int row = 0;
    int begin = 0, end = 0;
    std::uint16_t value = 0;  ///< grey value; sums of such where light was added up

    bool operator==(const Run&) const = default;
};

/// Ordered by row, then column; dark pixels are in none.
using Runs = std::vector<Run>;

/// The lit pixels of an image.
[[nodiscard]] Runs runs_of(const job::Image& image);

/// Pixel by pixel sum; `width` is that of the frame.
[[nodiscard]] Runs sum_of(const std::vector<Runs>& parts, int width);

/// Grey values added up: 255 for every fully lit pixel.
[[nodiscard]] long long light_of(const Runs& runs);

}  // namespace pliant::twin
