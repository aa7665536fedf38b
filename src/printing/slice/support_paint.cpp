#include "printing/slice/support_paint.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::slice {
namespace {

constexpr int cell_px = 32;
constexpr double looks_down = -0.01;  // limit of the normal's z: half a degree below a vertical wall

}  // namespace

Status check(const SupportTouch& t) {
    constexpr double most_um = 100000;
    if (!is_finite(t.at_um) || !is_finite(t.normal)) return input_error("painted supports: a number is not finite");
    if (!(norm(t.normal) > 0)) return input_error("painted supports: a normal of length 0");
    if (!(t.radius_um > 0 && t.radius_um <= most_um))
        return input_error("painted supports: a radius of {:.6g} mm: must be above 0 and at most 100 mm",
                           t.radius_um / 1000);
    return {};
}

SupportPaint::SupportPaint(std::span<const SupportTouch> touches, const Raster& raster, const Layers& layers)
    : layers_(layers),
      pixel_um_(raster.pixel_um),
      rows_(raster.height_px / cell_px + 1),
      columns_(raster.width_px / cell_px + 1) {
    const RasterFrame frame(raster, 1);
    for (const SupportTouch& t : touches) {
        if (t.normal.z / norm(t.normal) > looks_down) continue;
        spots_.push_back(
            {t.wish, frame.row(t.at_um.x, t.at_um.y), frame.column(t.at_um.x, t.at_um.y), t.at_um.z, t.radius_um});
    }
    if (spots_.empty()) return;
    cells_.resize(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_));
    for (std::size_t i = 0; i < spots_.size(); ++i) {
        const Spot& s = spots_[i];
        const double reach = s.radius_um / pixel_um_ + 1;
        for (int r = cell_row(s.row - reach); r <= cell_row(s.row + reach); ++r) {
            for (int c = cell_column(s.column - reach); c <= cell_column(s.column + reach); ++c)
                cells_[static_cast<std::size_t>(r * columns_ + c)].push_back(static_cast<int>(i));
        }
    }
}

int SupportPaint::cell_row(double row) const {
    return static_cast<int>(std::clamp(std::floor(row / cell_px), 0.0, rows_ - 1.0));
}

int SupportPaint::cell_column(double column) const {
    return static_cast<int>(std::clamp(std::floor(column / cell_px), 0.0, columns_ - 1.0));
}

std::vector<std::pair<int, int>> SupportPaint::middles(int layer) const {
    std::vector<std::pair<int, int>> pixels;
    for (const Spot& s : spots_) {
        if (std::fabs(layers_.bottom_um(layer) - s.z_um) <= layers_.thickness_um(layer))
            pixels.emplace_back(static_cast<int>(std::floor(s.row)), static_cast<int>(std::floor(s.column)));
    }
    return pixels;
}

SupportWish SupportPaint::at(int layer, int row, int column) const {
    if (spots_.empty()) return SupportWish::usual;
    const auto& cell = cells_[static_cast<std::size_t>(cell_row(row) * columns_ + cell_column(column))];
    const double z_um = layers_.bottom_um(layer), slack_um = layers_.thickness_um(layer);
    for (auto i = cell.rbegin(); i != cell.rend(); ++i) {
        const Spot& s = spots_[static_cast<std::size_t>(*i)];
        // A surface between two layers is visible at one of them.
        const double up = std::max(0.0, std::fabs(z_um - s.z_um) - slack_um);
        const double across = std::hypot(row + 0.5 - s.row, column + 0.5 - s.column) * pixel_um_;
        if (std::hypot(across, up) <= s.radius_um) return s.wish;
    }
    return SupportWish::usual;
}

}  // namespace pliant::slice
