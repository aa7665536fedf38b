// Scaling and rotating a part, and arranging copies of it.
#pragma once

#include <string>
#include <vector>

#include "printing/slice/body.hpp"
#include "printing/slice/raster_frame.hpp"

namespace pliant::slice {

/// Scales all bodies by `factor` about the origin. Errors: a factor outside 0.001 to 1000.
[[nodiscard]] Status scale(std::vector<Body>& bodies, double factor);

/// Rotates all bodies about x, then y, then z, in degrees, counter-clockwise seen from the axis' end. Quarter turns are
/// exact. Errors: a body of slices rotated about an axis other than z.
[[nodiscard]] Status turn(std::vector<Body>& bodies, const Vec3& degrees);

/// Where copies may stand: around the middle of the platform, within the image, which may be turned or not in its
/// middle.
class Room {
public:
    Room(const Raster& raster);  // NOLINT: implicit on purpose, an image is a room
    /// Nor may they stand beside a platform of this size.
    void limit(double width_um, double depth_um);

    /// Of the room; if the image is turned by no quarter turn, of its bounding box.
    [[nodiscard]] double width_um() const { return width_um_; }
    [[nodiscard]] double depth_um() const { return depth_um_; }
    /// "an image", "the platform".
    [[nodiscard]] std::string name() const;
    /// Whether copies of this size all together have room.
    [[nodiscard]] bool holds(double x_um, double y_um) const;

private:
    double width_um_, depth_um_;
    double column_um_, row_um_;  ///< along the image's rows and columns
    double cosine_, sine_;       ///< of its rotation, without signs
    bool off_centre_, on_platform_ = false;
};

/// Repeats the part `count` times in a grid of as few rows as the room allows, `spacing_um` apart; place the
/// result with place_on_platform(). Names of copies end in " #2", " #3" and so on. Errors, with numbers: fewer than 1
/// or more than 10000 copies, a negative spacing, or more copies than there is room for.
[[nodiscard]] Status repeat(std::vector<Body>& bodies, int count, double spacing_um, const Room& room);

}  // namespace pliant::slice
