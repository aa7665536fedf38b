// A grey image as runs of equal pixels: the form of a layer between outlines and file.
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

/// An image that stores only lit pixels. Memory and traversal cost are proportional to the number of runs, about two
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

    /// Adds pixels to the right of, or below, all present ones. Neighbours of equal value are merged into one run;
    /// value 0 adds nothing. Precondition: 0 <= row < height_px, 0 <= begin < end <= width_px.
    void append(int row, int begin, int end, std::uint8_t value);

    /// The rows with runs are within [first_row, end_row); 0, 0 for a blank image.
    [[nodiscard]] int first_row() const { return first_row_; }
    [[nodiscard]] int end_row() const { return first_row_ + static_cast<int>(starts_.size()); }
    /// From left to right; adjacent runs differ in value; empty for any row outside.
    [[nodiscard]] std::span<const Run> row(int row) const;

    /// 0 outside the image.
    [[nodiscard]] std::uint8_t at(int row, int column) const;
    [[nodiscard]] std::int64_t value_sum() const;
    [[nodiscard]] Image to_image() const;
    bool operator==(const RunImage&) const = default;

private:
    int width_px_ = 0, height_px_ = 0, first_row_ = 0;
    std::vector<std::uint32_t> starts_;  ///< per row from first_row_ on: index of its first run
    std::vector<Run> runs_;
};

}  // namespace pliant::slice
