// Sets of pixels as runs, and what sets are made of each other: union, intersection, difference, offset.
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

/// Pixels of an image. Memory and cost go with runs, never with areas.
class RunSet {
public:
    RunSet() = default;
    RunSet(int width_px, int height_px) : width_px_(width_px), height_px_(height_px) {}
    /// The pixels of an image that have any light.
    [[nodiscard]] static RunSet lit(const RunImage& image);

    [[nodiscard]] int width_px() const { return width_px_; }
    [[nodiscard]] int height_px() const { return height_px_; }
    [[nodiscard]] bool empty() const { return pixels() == 0; }
    /// All pixels lie in rows [first_row, end_row).
    [[nodiscard]] int first_row() const { return first_row_; }
    [[nodiscard]] int end_row() const { return first_row_ + static_cast<int>(rows_.size()); }
    /// From left to right, never touching; empty for any row outside.
    [[nodiscard]] std::span<const PixelSpan> row(int row) const;
    [[nodiscard]] std::int64_t pixels() const;

    /// Replaces a row. Rows come in rising order; spans from left to right, never touching, inside the image.
    void append_row(int row, std::vector<PixelSpan> spans);

private:
    int width_px_ = 0, height_px_ = 0, first_row_ = 0;
    std::vector<std::vector<PixelSpan>> rows_;
};

/// Precondition of all: sets of the same image size.
[[nodiscard]] RunSet united(const RunSet& a, const RunSet& b);
[[nodiscard]] RunSet common(const RunSet& a, const RunSet& b);
[[nodiscard]] RunSet without(const RunSet& a, const RunSet& b);
/// The image's pixels that are not in the set.
[[nodiscard]] RunSet complement(const RunSet& set);

/// Pixels whose centres lie no farther than `radius_px` from one of the set's: its offset outwards, corners rounded.
/// Straight sides move by exactly `radius_px`. Cost: spans times (2 radius + 1).
[[nodiscard]] RunSet grown(const RunSet& set, int radius_px);
/// The set without what lies within `radius_px` of a pixel that is not in it; beyond the image's border nothing does.
[[nodiscard]] RunSet shrunk(const RunSet& set, int radius_px);

/// Pixels from which one of the set's lies at most `left`, `right` columns and `up`, `down` rows away (a rectangle).
struct Reach {
    int left = 0, right = 0, up = 0, down = 0;
};
[[nodiscard]] RunSet reaching(const RunSet& set, const Reach& reach);

}  // namespace pliant::slice
