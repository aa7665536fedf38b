// The smooth faces that bound a drawn solid, each as an equation, to tell how a surface point moves with the parameters
// of the drawing.
#pragma once

#include <vector>

#include "base/core/vec3.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh {

/// A part of a plane, a sphere or a cylinder; after unions and cuts only some of it may be surface.
struct SurfacePiece {
    enum class Kind {
        plane,     ///< bounded by `loops`
        disk,      ///< in a plane, within `radius` of `point`
        sphere,    ///< about `point`
        cylinder,  ///< about the line from `point` along `direction`, whose length is the cylinder's
        drawn,     ///< from a file, rotated and moved; `point` and `direction` tell where it is
    };
    Kind kind = Kind::plane;
    Vec3 point;      ///< on the piece, or its centre
    Vec3 direction;  ///< unit normal of planes and disks
    double radius = 0;
    std::vector<std::vector<Vec3>> loops{};  ///< in the plane: the outline, then holes

    /// Signed distance from the whole plane, sphere or cylinder.
    [[nodiscard]] double distance(const Vec3& p) const;
    /// Gradient of distance(), of length 1.
    [[nodiscard]] Vec3 normal(const Vec3& p) const;
    /// True if the point is on the piece or nearer to it than `within`.
    [[nodiscard]] bool holds(const Vec3& p, double within) const;
};

/// Of all solids in the expression, in an order that does not depend on its numbers.
[[nodiscard]] std::vector<SurfacePiece> surface_pieces(const Solid& solid);

}  // namespace pliant::mesh
