#include "presentation/draw/stage_layout.hpp"

#include <algorithm>
#include <array>

#include "base/core/boxes.hpp"

namespace pliant::report {
namespace {

constexpr std::array<double, 4> panel_margins = {0.06, 0.06, 0.10, 0.17};  // the top margin holds the caption

double mean_depth(const Camera& camera, std::span<const Vec3> points) {
    return camera.project(bounds_of(points).center())[2];
}

}  // namespace

StageLayout lay_out_stages(const Camera& view, std::span<const Vec3> points, std::size_t step_count, int width_px,
                           int height_px) {
    static constexpr std::array<std::array<int, 2>, 6> grids = {{{2, 2}, {3, 2}, {2, 3}, {4, 1}, {5, 1}, {1, 4}}};
    StageLayout best;
    double best_scale = 0;
    for (const auto& [columns, rows] : grids) {
        StageLayout layout{columns, rows, width_px / columns, height_px / rows, {}, {}};
        layout.camera =
            fitted(view, points, static_cast<double>(layout.panel_width_px) / layout.panel_height_px, panel_margins);
        const double scale = layout.panel_height_px / (layout.camera.half_height * mean_depth(layout.camera, points));
        if (scale > best_scale) {
            best_scale = scale;
            best = std::move(layout);
        }
    }
    const std::size_t panels = std::min(static_cast<std::size_t>(best.columns * best.rows), step_count);
    for (std::size_t i = 0; i < panels; ++i) {
        best.steps.push_back(panels == 1 ? 0 : (i * (step_count - 1) + (panels - 1) / 2) / (panels - 1));
    }
    return best;
}

}  // namespace pliant::report
