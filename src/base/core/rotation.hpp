// Rotations about an axis.
#pragma once

#include <cmath>

#include "base/core/vec3.hpp"

namespace pliant {

/// `from` plus `arm` rotated by an angle, right-handed about the unit vector `axis`: Rodrigues' formula. Its terms are
/// added to `from` one after the other.
[[nodiscard]] inline Vec3 turned(const Vec3& arm, const Vec3& axis, double angle_rad, const Vec3& from = {}) {
    const double c = std::cos(angle_rad), s = std::sin(angle_rad);
    return from + c * arm + s * cross(axis, arm) + (1 - c) * dot(axis, arm) * axis;
}

}  // namespace pliant
