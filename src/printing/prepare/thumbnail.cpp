#include "printing/prepare/thumbnail.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant::job {
namespace {

constexpr std::array<double, 6> greys{255, 150, 205, 110, 180, 80};

}  // namespace

Thumbnail::Thumbnail(int width_px) : width_px_(width_px), bins_(std::min(width_px, 2 * side_px)) {}

std::vector<Thumbnail::Spot> Thumbnail::row(const slice::ComposedLayer& layer) const {
    const auto bins = static_cast<std::size_t>(bins_);
    std::vector<int> change(bins + 1), depth(bins, 0), most(bins, 0);
    std::vector<Spot> row(bins);
    for (const slice::MaterialImage& m : layer.images) {
        std::fill(change.begin(), change.end(), 0);
        for (int r = m.image.first_row(); r < m.image.end_row(); ++r) {
            for (const slice::Run& run : m.image.row(r)) {
                const auto first = static_cast<std::size_t>(std::int64_t{run.begin} * bins_ / width_px_);
                const auto last = static_cast<std::size_t>((std::int64_t{run.end} - 1) * bins_ / width_px_);
                ++change[first];
                --change[last + 1];
            }
        }
        int here = 0;
        for (std::size_t b = 0; b < bins; ++b) {
            here += change[b];
            depth[b] += here;
            if (here > most[b]) {
                most[b] = here;
                row[b].material = static_cast<std::uint8_t>(m.material);
            }
            row[b].depth_px = static_cast<std::uint16_t>(std::min(depth[b], 65535));
        }
    }
    return row;
}

slice::Image Thumbnail::picture(const slice::Layers& layers, double pixel_um) const {
    slice::Image image{side_px, side_px, std::vector<std::uint8_t>(std::size_t{side_px} * side_px, 0)};
    int left = bins_, right = 0, deepest = 1;
    for (std::size_t i = 0; i < spots_.size(); ++i) {
        if (spots_[i].depth_px == 0) continue;
        const int bin = static_cast<int>(i % static_cast<std::size_t>(bins_));
        left = std::min(left, bin);
        right = std::max(right, bin + 1);
        deepest = std::max<int>(deepest, spots_[i].depth_px);
    }
    const int count = static_cast<int>(spots_.size() / static_cast<std::size_t>(bins_));
    if (left >= right) return image;
    const double bin_um = pixel_um * width_px_ / bins_, width_um = (right - left) * bin_um;
    const double height_um = layers.top_um(count - 1), um_per_px = std::max(width_um, height_um) / (side_px - 20);
    for (int y = 0; y < side_px; ++y) {
        const double z_um = height_um / 2 + (side_px / 2.0 - y - 0.5) * um_per_px;
        if (z_um < 0 || z_um >= height_um) continue;
        const int near = layers.middles_up_to(static_cast<std::int64_t>(z_um), 1);
        const int k = std::clamp(near > 0 && z_um < layers.top_um(near - 1) ? near - 1 : near, 0, count - 1);
        for (int x = 0; x < side_px; ++x) {
            const double at = (left + right) / 2.0 + (x + 0.5 - side_px / 2.0) * um_per_px / bin_um;
            if (at < left || at >= right) continue;
            const Spot& spot =
                spots_[static_cast<std::size_t>(k) * static_cast<std::size_t>(bins_) + static_cast<std::size_t>(at)];
            if (spot.depth_px == 0) continue;
            const double strength = 0.5 + 0.5 * spot.depth_px / deepest;
            image.pixels[static_cast<std::size_t>(y) * side_px + static_cast<std::size_t>(x)] =
                static_cast<std::uint8_t>(std::lround(greys[spot.material % greys.size()] * strength));
        }
    }
    return image;
}

}  // namespace pliant::job
