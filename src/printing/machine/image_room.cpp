#include "printing/machine/image_room.hpp"

namespace pliant::machine {

slice::Raster raster_of(const Projector& p) {
    return {p.width_px, p.height_px, p.pixel_um, p.mirror_x, p.mirror_y, p.rotation_deg, p.offset_x_um, p.offset_y_um};
}

job::PlatformEdge platform_edge(const Printer& printer) {
    return {raster_of(printer.projector), static_cast<double>(printer.platform.width_um),
            static_cast<double>(printer.platform.depth_um)};
}

}  // namespace pliant::machine
