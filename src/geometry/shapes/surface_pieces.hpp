// The smooth pieces of surface that a drawn solid is bounded by, each as an equation: so that it can be told how a
// point of the surface moves with the numbers of a drawing.
#pragma once

#include <vector>

#include "base/core/vec3.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh {

/// A part of a plane, a sphere or a cylinder; unions and cuts may use only a part of it.
struct SurfacePiece {
    enum class Kind {
        plane,     ///< `loops` bound it
        disk,      ///< of a plane, within `radius` of `point`
        sphere,    ///< about `point`
        cylinder,  ///< about the line from `point` along `direction`, which is as long as it
        drawn,     ///< of a file, turned and moved; `point` and `direction` tell where it is
    };
    Kind kind = Kind::plane;
    Vec3 point;      ///< on it, or its centre
    Vec3 direction;  ///< of planes and disks the unit normal
    double radius = 0;
    std::vector<std::vector<Vec3>> loops{};  ///< in the plane: the outline, then holes

    /// Distance from the whole plane, sphere or cylinder, with a sign.
    [[nodiscard]] double distance(const Vec3& p) const;
    /// Its gradient, of length 1.
    [[nodiscard]] Vec3 normal(const Vec3& p) const;
    /// The point is on the piece, or nearer to it than `within`.
    [[nodiscard]] bool holds(const Vec3& p, double within) const;
};

/// Of all solids that it is made of, in an order that the same expression with other numbers keeps.
[[nodiscard]] std::vector<SurfacePiece> surface_pieces(const Solid& solid);

}  // namespace pliant::mesh
