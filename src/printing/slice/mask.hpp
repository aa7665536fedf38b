// Restricting and combining images.
#pragma once

#include "printing/slice/run_image.hpp"
#include "printing/slice/run_set.hpp"

namespace pliant::slice {

/// The pixels of an image that are inside a set, or outside of it. Precondition: both of the same size.
[[nodiscard]] RunImage inside(const RunImage& image, const RunSet& set);
[[nodiscard]] RunImage outside(const RunImage& image, const RunSet& set);

/// The smaller value at every pixel. Precondition: both of the same size.
[[nodiscard]] RunImage lesser(const RunImage& a, const RunImage& b);

/// The union of two images. Precondition: no pixel is lit in both.
[[nodiscard]] RunImage together(const RunImage& a, const RunImage& b);

}  // namespace pliant::slice
