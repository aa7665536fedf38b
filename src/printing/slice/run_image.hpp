// A grey image as runs of equal pixels: what a layer is on its way from outlines to a file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "printing/slice/image.hpp"

namespace pliant::slice {

/// Pixels [begin, end) of a row, all of one value above 0.
struct Run {
    std::uint16_t begin = 0, end = 0;
    std::uint8_t value = 0;
    bool operator==(const Run&) const = default;
};

/// An image of which only lit pixels are kept. Its memory and every walk over it go with the number of runs, about two
/// for each pixel that an outline passes through, whatever the size of the image.
class RunImage {
public:
    RunImage() = default;
    /// Sides of 0 to 65535 pixels.
    RunImage(int width_px, int height_px) : width_px_(width_px), height_px_(height_px) {}
    [[nodiscard]] static RunImage from_image(const Image& image);

    [[nodiscard]] int width_px() const { return width_px_; }
    [[nodiscard]] int height_px() const { return height_px_; }
    [[nodiscard]] bool blank() const { return runs_.empty(); }

    /// Adds pixels to the right of, or below, all that are there. Neighbours of equal value become one run; value 0
    /// adds nothing. Precondition: 0 <= row < height_px, 0 <= begin < end <= width_px.
    void append(int row, int begin, int end, std::uint8_t value);

    /// The rows that hold runs lie in [first_row, end_row); 0, 0 for a blank image.
    [[nodiscard]] int first_row() const { return first_row_; }
    [[nodiscard]] int end_row() const { return first_row_ + static_cast<int>(starts_.size()); }
    /// From left to right, never touching with equal values; empty for any row outside.
    [[nodiscard]] std::span<const Run> row(int row) const;

    /// 0 outside the image.
    [[nodiscard]] std::uint8_t at(int row, int column) const;
    [[nodiscard]] std::int64_t value_sum() const;
    [[nodiscard]] Image to_image() const;
    bool operator==(const RunImage&) const = default;

private:
    int width_px_ = 0, height_px_ = 0, first_row_ = 0;
    std::vector<std::uint32_t> starts_;  ///< per row from first_row_ on: its first run
    std::vector<Run> runs_;
};

}  // namespace pliant::slice
