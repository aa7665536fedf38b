// Layout of several small pictures in one.
#pragma once

#include <span>
#include <vector>

#include "presentation/draw/camera.hpp"

namespace pliant::report {

struct StageLayout {
    int columns = 1, rows = 1;
    int panel_width_px = 0, panel_height_px = 0;
    Camera camera;                   ///< common to all panels
    std::vector<std::size_t> steps;  ///< one per panel, row by row; the first is rest, the last the end
};

/// The arrangement of at most four to six panels in which the robot is largest. `points` must all be visible;
/// `step_count` includes the rest state.
[[nodiscard]] StageLayout lay_out_stages(const Camera& view, std::span<const Vec3> points, std::size_t step_count,
                                         int width_px, int height_px);

}  // namespace pliant::report
