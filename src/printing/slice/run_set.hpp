// Sets of pixels as runs, with union, intersection, difference and offset.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "printing/slice/run_image.hpp"

namespace pliant::slice {

/// Pixels [begin, end) of a row.
struct PixelSpan {
    int begin = 0, end = 0;
    bool operator==(const PixelSpan&) const = default;
};

/// Pixels of an image. Memory and cost are proportional to the runs, not the area.
class RunSet {
public:
    RunSet() = default;
    RunSet(int width_px, int height_px) : width_px_(width_px), height_px_(height_px) {}
    /// The lit pixels of an image.
    [[nodiscard]] static RunSet lit(const RunImage& image);

    [[nodiscard]] int width_px() const { return width_px_; }
    [[nodiscard]] int height_px() const { return height_px_; }
    [[nodiscard]] bool empty() const { return pixels() == 0; }
    /// All pixels are in rows [first_row, end_row).
    [[nodiscard]] int first_row() const { return first_row_; }
    [[nodiscard]] int end_row() const { return first_row_ + static_cast<int>(rows_.size()); }
    /// From left to right, not adjacent; empty for any row outside.
    [[nodiscard]] std::span<const PixelSpan> row(int row) const;
    [[nodiscard]] std::int64_t pixels() const;

    /// Replaces a row. Rows must ascend; spans go from left to right, are not adjacent, and are inside the image.
    void append_row(int row, std::vector<PixelSpan> spans);

private:
    int width_px_ = 0, height_px_ = 0, first_row_ = 0;
    std::vector<std::vector<PixelSpan>> rows_;
};

/// Precondition of all three: sets of the same image size.
[[nodiscard]] RunSet united(const RunSet& a, const RunSet& b);
[[nodiscard]] RunSet common(const RunSet& a, const RunSet& b);
[[nodiscard]] RunSet without(const RunSet& a, const RunSet& b);
/// The image's pixels that are not in the set.
[[nodiscard]] RunSet complement(const RunSet& set);

/// Pixels whose centres are at most `radius_px` from that of a pixel of the set: the outward offset, with rounded
/// corners. Straight sides move by exactly `radius_px`. Cost: spans times (2 radius + 1).
[[nodiscard]] RunSet grown(const RunSet& set, int radius_px);
/// The set without the pixels within `radius_px` of a pixel outside it; pixels beyond the image's border do not count.
[[nodiscard]] RunSet shrunk(const RunSet& set, int radius_px);

/// Pixels for which the set has one at most `left`, `right` columns and `up`, `down` rows away (a rectangle).
struct Reach {
    int left = 0, right = 0, up = 0, down = 0;
};
[[nodiscard]] RunSet reaching(const RunSet& set, const Reach& reach);

}  // namespace pliant::slice
