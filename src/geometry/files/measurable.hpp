// How large the coordinates of a file may be.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/core/vec3.hpp"

namespace pliant::mesh {

/// Volumes and their squares stay below the largest double, whatever the unit.
inline constexpr double farthest = 1e30;
inline constexpr const char* too_far = "coordinates go up to 1e30, so that volumes can be computed";

[[nodiscard]] inline bool is_measurable(const Vec3& p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= farthest;
}

}  // namespace pliant::mesh
