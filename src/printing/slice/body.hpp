// What the slicer is given: bodies on the platform, and the raster that they are drawn on.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::slice {

/// What a body fills from `bottom_um` up to `top_um`: closed outlines, counter-clockwise around material, whose last
/// point joins the first.
struct OutlineSlice {
    double bottom_um = 0, top_um = 0;
    std::vector<std::vector<std::array<double, 2>>> outlines_um;
};

/// A body that is one material at `from_um` and more and more another on the way to `to_um`: `shares` of the second are
/// evenly spaced on that way, straight lines between them, and go on unchanged before and after it.
struct Blend {
    std::string second;
    Vec3 from_um, to_um;
    std::vector<double> shares{0, 1};
    int cell_px = 1;     ///< edge of the squares that are one material or the other
    double cell_um = 0;  ///< the same as a length, rounded to pixels; 0: `cell_px` counts
};

/// A solid of one material, or of two where it has a blend. Points are in micrometres on the platform: z up, z = 0 is
/// the platform, the image's centre is the origin of x and y.
struct Body {
    std::string material;
    mesh::TriMesh surface_um;
    std::string name;  ///< for messages; where empty, the body's number is used
    std::vector<OutlineSlice>
        slices{};  ///< from the bottom up; where there are any, they are the body, not the surface
    std::optional<Blend> blend{};
    bool filler = false;  ///< gives way to the part (put it first), and nobody needs to hear of it
};

/// The projector's picture on the platform. x runs to the right and row 0 lies at the greatest y, unless mirrored. The
/// part is turned about the platform's centre, moved, then mirrored.
struct Raster {
    int width_px = 0;
    int height_px = 0;
    double pixel_um = 0;  ///< edge length of a (square) pixel
    bool mirror_x = false;
    bool mirror_y = false;
    double rotation_deg = 0;  ///< counter-clockwise, seen from above
    double offset_x_um = 0;   ///< of the platform's centre from the image's
    double offset_y_um = 0;

    [[nodiscard]] double width_um() const { return width_px * pixel_um; }
    [[nodiscard]] double height_um() const { return height_px * pixel_um; }
};

/// Refuses a raster of no pixels, of more than 2^28, with a pixel that is not in (0, 10] mm, or a turn or an offset
/// that is no number of reasonable size.
[[nodiscard]] Status check(const Raster& raster);

void move(Body& body, const Vec3& shift_um);

/// Around the points that triangles use, or the outlines of slices. Errors name the body: a corner that does not exist,
/// a number that is not finite.
[[nodiscard]] Result<Box3> bounds(const Body& body, const std::string& label);

/// "body 'finger' (soft)" or "body 3 (soft)", counted from 1.
[[nodiscard]] std::string describe(const Body& body, std::size_t index);

}  // namespace pliant::slice
