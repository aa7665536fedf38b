// The shapes that supports are made of.
#pragma once

#include <array>
#include <vector>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::slice {

/// A height and the radius there.
struct Ring {
    double z_um, radius_um;
};

/// An upright solid of revolution with 16 sides around (x, y): rings from the bottom up, radii above 0. Each ring's
/// corners are outside its circle so that the areas are equal.
[[nodiscard]] mesh::TriMesh turned_solid(double x_um, double y_um, const std::vector<Ring>& rings);

/// A slanted rod: every horizontal section is a polygon of 16 sides with the area of a circle of `radius_um`, centred
/// on the line from `from_um` to `to_um`. Precondition: `to_um` is higher.
[[nodiscard]] mesh::TriMesh rod(const Vec3& from_um, const Vec3& to_um, double radius_um);

/// An upright prism over the convex hull of points, offset outwards by `margin_um` with round corners. Precondition: at
/// least one point.
[[nodiscard]] mesh::TriMesh hull_prism(const std::vector<std::array<double, 2>>& points_um, double margin_um,
                                       double bottom_um, double top_um);

}  // namespace pliant::slice
