#include "printing/job/platform_edge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pliant::job {

PlatformEdge::PlatformEdge(const slice::Raster& raster, double width_um, double depth_um)
    : half_x_um_(width_um / 2),
      half_y_um_(depth_um / 2),
      width_um_(slice::image_extent(raster).x_um),
      depth_um_(slice::image_extent(raster).y_um),
      pixel_um_(raster.pixel_um),
      limits_(half_x_um_ > 0 && half_y_um_ > 0 && (2 * half_x_um_ < width_um_ || 2 * half_y_um_ < depth_um_)),
      frame_(raster, 1) {
    if (!limits_) return;
    width_um_ = std::min(width_um_, 2 * half_x_um_);
    depth_um_ = std::min(depth_um_, 2 * half_y_um_);
}

Beyond PlatformEdge::beyond_place(double x_um, double y_um, double slack_um) const {
    Beyond beyond;
    if (half_x_um_ <= 0 || half_y_um_ <= 0) return beyond;
    const double over_x = std::fabs(x_um) - half_x_um_, over_y = std::fabs(y_um) - half_y_um_;
    if (over_x > slack_um) beyond.merge({over_x, 'x', x_um < 0});
    if (over_y > slack_um) beyond.merge({over_y, 'y', y_um < 0});
    return beyond;
}

Beyond PlatformEdge::beyond(const Box3& box_um) const {
    constexpr double rounding_um = 1;
    Beyond beyond = beyond_place(box_um.low.x, box_um.low.y, rounding_um);
    beyond.merge(beyond_place(box_um.high.x, box_um.high.y, rounding_um));
    return beyond;
}

Beyond PlatformEdge::beyond(int row, int begin, int end) const {
    const auto of_pixel = [&](int column) {
        const auto [x_um, y_um] = frame_.place(column + 0.5, row + 0.5);
        return beyond_place(x_um, y_um, pixel_um_);
    };
    Beyond beyond = of_pixel(begin);
    beyond.merge(of_pixel(end - 1));
    return beyond;
}

Beyond PlatformEdge::beyond(const slice::RunImage& image) const {
    Beyond beyond;
    for (int row = image.first_row(); row < image.end_row(); ++row) {
        for (const auto& run : image.row(row)) beyond.merge(this->beyond(row, run.begin, run.end));
    }
    return beyond;
}

std::string PlatformEdge::text(const Beyond& beyond) const {
    const double half_mm = (beyond.axis == 'x' ? half_x_um_ : half_y_um_) / 1000;
    return fmt::format("lies {:.3f} mm beyond the platform at {}{}, which reaches from {:.3f} to {:.3f} mm there",
                       beyond.um / 1000, beyond.negative ? '-' : '+', beyond.axis, -half_mm, half_mm);
}

Status check_on_platform(const PlatformEdge& edge, const Box3& box_um, const std::string& label) {
    const Beyond beyond = edge.beyond(box_um);
    if (beyond.um <= 0) return {};
    return input_error("{}: {}; move, turn or scale the part", label, edge.text(beyond));
}

}  // namespace pliant::job
