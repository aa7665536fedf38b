#include "printing/machine/image_room.hpp"

#include <cmath>

namespace pliant::machine {

slice::Raster raster_of(const Projector& p) {
    return {p.width_px, p.height_px, p.pixel_um, p.mirror_x, p.mirror_y, p.rotation_deg, p.offset_x_um, p.offset_y_um};
}

std::vector<std::string> other_images(const Projector& a, const Projector& b) {
    constexpr double same_deg = 1e-9, same_um = 1e-6;
    std::vector<std::string> keys;
    if (a.mirror_x != b.mirror_x) keys.emplace_back("mirror_x");
    if (a.mirror_y != b.mirror_y) keys.emplace_back("mirror_y");
    if (std::fabs(std::remainder(a.rotation_deg - b.rotation_deg, 360.0)) > same_deg) keys.emplace_back("rotation");
    if (std::hypot(a.offset_x_um - b.offset_x_um, a.offset_y_um - b.offset_y_um) > same_um) keys.emplace_back("offset");
    if (a.grey != b.grey) keys.emplace_back("grey");
    if (a.mask != b.mask) keys.emplace_back("mask");
    return keys;
}

job::PlatformEdge platform_edge(const Printer& printer) {
    return {raster_of(printer.projector), static_cast<double>(printer.platform.width_um),
            static_cast<double>(printer.platform.depth_um)};
}

}  // namespace pliant::machine
