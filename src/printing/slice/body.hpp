// Input of the slicer: bodies on the platform, and the raster.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::slice {

/// The region of a body from `bottom_um` to `top_um`: closed outlines, counter-clockwise around material, whose last
/// point joins the first.
struct OutlineSlice {
    double bottom_um = 0, top_um = 0;
    std::vector<std::vector<std::array<double, 2>>> outlines_um;
};

/// A body that grades from one material at `from_um` to another at `to_um`: `shares` are evenly spaced fractions of the
/// second material along that line, linear in between and constant beyond the ends.
struct Blend {
    std::string second;
    Vec3 from_um, to_um;
    std::vector<double> shares{0, 1};
    int cell_px = 1;     ///< edge of the squares that consist of one material
    double cell_um = 0;  ///< the same as a length, rounded to pixels; 0: `cell_px` is used
};

/// A solid of one material, or of two if it has a blend. Points are in micrometres on the platform: z up, z = 0 is the
/// platform, the image's centre is the origin of x and y.
struct Body {
    std::string material;
    mesh::TriMesh surface_um;
    std::string name;  ///< for messages; if empty, the body's number is used
    std::vector<OutlineSlice>
        slices{};  ///< from the bottom up; if present, they define the body instead of the surface
    std::optional<Blend> blend{};
    bool filler = false;  ///< yields to the part without a warning (put it first)
    /// Later bodies are cut out of it, but chords of common curved faces deviate by up to this; 0: they are not.
    double chord_um = 0;
    std::vector<mesh::TriMesh> air_um{};  ///< closed surfaces of space that is cut out of it; may reach beyond it
};

/// The projector's image on the platform. x runs to the right and row 0 is at the greatest y, unless mirrored. The part
/// is rotated about the platform's centre, moved, then mirrored.
struct Raster {
    int width_px = 0;
    int height_px = 0;
    double pixel_um = 0;  ///< edge length of a (square) pixel
    bool mirror_x = false;
    bool mirror_y = false;
    double rotation_deg = 0;  ///< counter-clockwise, seen from above
    double offset_x_um = 0;   ///< platform's centre from the image's centre
    double offset_y_um = 0;

    [[nodiscard]] double width_um() const { return width_px * pixel_um; }
    [[nodiscard]] double height_um() const { return height_px * pixel_um; }
};

/// Errors: a raster of no pixels or more than 2^28, a pixel outside (0, 10] mm, a rotation or offset that is not finite
/// or unreasonably large.
[[nodiscard]] Status check(const Raster& raster);

/// Of its surface and of what is cut out of it.
template <class Visit>
void each_point(Body& body, const Visit& visit) {
    for (Vec3& p : body.surface_um.points) visit(p);
    for (mesh::TriMesh& air : body.air_um) {
        for (Vec3& p : air.points) visit(p);
    }
}

void move(Body& body, const Vec3& shift_um);

/// Bounds of the points used by triangles, or of the slices' outlines. Errors name the body: a missing corner, a number
/// that is not finite.
[[nodiscard]] Result<Box3> bounds(const Body& body, const std::string& label);

/// "body 'finger' (soft)" or "body 3 (soft)", counted from 1.
[[nodiscard]] std::string describe(const Body& body, std::size_t index);

}  // namespace pliant::slice
