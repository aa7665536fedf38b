// Whether surfaces have already passed through each other.
#pragma once

#include "core/vec3.hpp"

namespace pliant::sim::contact {

/// True if the segment from a to b passes through the inside of the triangle. Merely touching does not count.
[[nodiscard]] bool segment_crosses_triangle(const Vec3& a, const Vec3& b, const Vec3& t0, const Vec3& t1,
                                            const Vec3& t2);

}  // namespace pliant::sim::contact
