// Scaling and rotating a part, and arranging copies of it.
#pragma once

#include <string>
#include <vector>

#include "printing/slice/body.hpp"
#include "printing/slice/raster_frame.hpp"

namespace pliant::slice {

/// Scales all bodies by `factor` about the origin. Errors: a factor outside 0.01 to 100.
[[nodiscard]] Status scale(std::vector<Body>& bodies, double factor);

/// Rotates all bodies about x, then y, then z, in degrees, counter-clockwise seen from the axis' end. Quarter turns are
/// exact. Errors: a body of slices rotated about an axis other than z.
[[nodiscard]] Status turn(std::vector<Body>& bodies, const Vec3& degrees);

/// Where copies may stand.
struct Room {
    double width_um = 0, depth_um = 0;
    const char* name = "an image";

    Room(const Raster& raster) : Room(image_extent(raster)) {}
    Room(double width, double depth, const char* what) : width_um(width), depth_um(depth), name(what) {}

private:
    explicit Room(const ImageExtent& image) : width_um(image.x_um), depth_um(image.y_um) {}
};

/// Repeats the part `count` times in a grid of as few rows as the room's width allows, `spacing_um` apart; place the
/// result with place_on_platform(). Names of copies end in " #2", " #3" and so on. Errors, with numbers: fewer than 1
/// or more than 10000 copies, a negative spacing, or more copies than there is room for.
[[nodiscard]] Status repeat(std::vector<Body>& bodies, int count, double spacing_um, const Room& room);

}  // namespace pliant::slice
