// Distances from straight segments.
#pragma once

#include <algorithm>

#include "base/core/vec3.hpp"

namespace pliant {

/// Distance of `p` from the segment between `a` and `b`, which may be one point.
[[nodiscard]] inline double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 along = b - a;
    const double squared = dot(along, along);
    const double t = squared > 0 ? std::clamp(dot(p - a, along) / squared, 0.0, 1.0) : 0;
    return norm(p - a - t * along);
}

}  // namespace pliant
