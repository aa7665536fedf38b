#include "printing/machine/brush.hpp"

#include <algorithm>

namespace pliant::machine {

namespace {

constexpr int bristles_um = 200;  // minimum deflection: the brush still wipes a part this much higher

}  // namespace

void BrushWatch::move(const Position& from, const Position& to, int part_height_um) {
    if (!printer_->has_brush() || arrived_ || to[Axis::carriage] <= from[Axis::carriage]) return;
    const Carriage& c = printer_->carriage;
    const int above_rim_um =
        std::max(from[Axis::platform], to[Axis::platform]) - part_height_um - printer_->vat_shape.wall_um;
    const bool from_print = from[Axis::carriage] <= c.print_um + c.shear_um;
    if (from_print && to[Axis::carriage] <= c.print_um + c.shear_um) return;  // a shear stroke
    highest_um_ = from_print ? above_rim_um : std::max(highest_um_, above_rim_um);
    left_ = left_ || from_print;
    arrived_ = left_ && to[Axis::carriage] >= c.tower_um;
}

bool BrushWatch::wiped() const {
    return arrived_ && highest_um_ <= printer_->cleaning.brush_um + bristles_um;
}

}  // namespace pliant::machine
