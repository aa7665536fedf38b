// Whether surfaces intersect.
#pragma once

#include "base/core/vec3.hpp"

namespace pliant::sim::contact {

/// Whether a segment through an edge or corner of the triangle intersects the triangle. Bodies drawn flush have such
/// contacts at rest without intersecting; surfaces with matching meshes that have met later may have no others.
enum class Rim { left_out, counts };

/// True if the segment from a to b intersects the triangle. Merely touching does not count.
[[nodiscard]] bool segment_crosses_triangle(const Vec3& a, const Vec3& b, const Vec3& t0, const Vec3& t1,
                                            const Vec3& t2, Rim rim = Rim::left_out);
/// Where the line through a and b meets the plane of the triangle. Precondition: they lie on different sides of it.
[[nodiscard]] Vec3 point_in_plane(const Vec3& a, const Vec3& b, const Vec3& t0, const Vec3& t1, const Vec3& t2);

}  // namespace pliant::sim::contact
