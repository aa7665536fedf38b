#include "printing/slice/raster_frame.hpp"

#include <cmath>
#include <numbers>

namespace pliant::slice {
namespace {

struct Turn {
    double cosine, sine;
};

Turn turn_by(double degrees) {
    const double turned = std::remainder(degrees, 360.0);
    if (turned == 0) return {1, 0};
    if (std::fabs(turned) == 180) return {-1, 0};
    if (std::fabs(turned) == 90) return {0, turned > 0 ? 1.0 : -1.0};
    return {std::cos(turned * std::numbers::pi / 180), std::sin(turned * std::numbers::pi / 180)};
}

}  // namespace

RasterFrame::RasterFrame(const Raster& raster, double um_per_unit) {
    const Turn turn = turn_by(raster.rotation_deg);
    const double scale = um_per_unit / raster.pixel_um;
    const double right = raster.mirror_x ? -1 : 1, down = raster.mirror_y ? 1 : -1;
    xx_ = right * turn.cosine * scale;
    xy_ = -right * turn.sine * scale;
    yx_ = down * turn.sine * scale;
    yy_ = down * turn.cosine * scale;
    x0_ = right * raster.offset_x_um / raster.pixel_um + raster.width_px / 2.0;
    y0_ = down * raster.offset_y_um / raster.pixel_um + raster.height_px / 2.0;
    mirrored_ = raster.mirror_x != raster.mirror_y;
}

std::array<double, 2> turn_of(const Raster& raster) {
    const Turn turn = turn_by(raster.rotation_deg);
    return {std::fabs(turn.cosine), std::fabs(turn.sine)};
}

ImageExtent image_extent(const Raster& raster) {
    const auto [c, s] = turn_of(raster);
    return {c * raster.width_um() + s * raster.height_um(), s * raster.width_um() + c * raster.height_um()};
}

}  // namespace pliant::slice
