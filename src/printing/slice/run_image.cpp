#include "printing/slice/run_image.hpp"

#include <algorithm>
#include <cstring>

namespace pliant::slice {
namespace {

/// The end of the pixels from `begin` on with the same value as the first.
int run_end(const std::uint8_t* row, int begin, int width) {
    const std::uint64_t eight = 0x0101010101010101ULL * row[begin];
    int end = begin + 1;
    for (; end + 8 <= width; end += 8) {
        std::uint64_t word = 0;
        std::memcpy(&word, row + end, 8);
        if (word != eight) break;
    }
    while (end < width && row[end] == row[begin]) ++end;
    return end;
}

}  // namespace

RunImage RunImage::from_image(const Image& image) {
    RunImage runs(image.width_px, image.height_px);
    for (int row = 0; row < image.height_px; ++row) {
        const std::uint8_t* pixels = image.pixels.data() + static_cast<std::size_t>(row) * image.width_px;
        for (int begin = 0; begin < image.width_px;) {
            const int end = run_end(pixels, begin, image.width_px);
            runs.append(row, begin, end, pixels[begin]);
            begin = end;
        }
    }
    return runs;
}

void RunImage::append(int row, int begin, int end, std::uint8_t value) {
    if (value == 0) return;
    if (runs_.empty()) first_row_ = row;
    if (row < end_row()) {  // the last row already has a run
        Run& last = runs_.back();
        if (last.end == begin && last.value == value) {
            last.end = static_cast<std::uint16_t>(end);
            return;
        }
    } else {
        starts_.resize(static_cast<std::size_t>(row - first_row_) + 1, static_cast<std::uint32_t>(runs_.size()));
    }
    runs_.push_back({static_cast<std::uint16_t>(begin), static_cast<std::uint16_t>(end), value});
}

std::span<const Run> RunImage::row(int row) const {
    if (row < first_row_ || row >= end_row()) return {};
    const auto r = static_cast<std::size_t>(row - first_row_);
    const std::size_t end = r + 1 < starts_.size() ? starts_[r + 1] : runs_.size();
    return std::span(runs_).subspan(starts_[r], end - starts_[r]);
}

std::uint8_t RunImage::at(int row, int column) const {
    const std::span<const Run> runs = this->row(row);
    const auto found =
        std::upper_bound(runs.begin(), runs.end(), column, [](int c, const Run& r) { return c < r.end; });
    return found != runs.end() && found->begin <= column ? found->value : std::uint8_t{0};
}

std::int64_t RunImage::value_sum() const {
    std::int64_t sum = 0;
    for (const Run& r : runs_) sum += std::int64_t{r.value} * (r.end - r.begin);
    return sum;
}

Image RunImage::to_image() const {
    Image image{width_px_, height_px_, {}};
    image.pixels.resize(static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_));
    for (int r = first_row_; r < end_row(); ++r) {
        std::uint8_t* pixels = image.pixels.data() + static_cast<std::size_t>(r) * width_px_;
        for (const Run& run : row(r)) std::fill(pixels + run.begin, pixels + run.end, run.value);
    }
    return image;
}

}  // namespace pliant::slice
