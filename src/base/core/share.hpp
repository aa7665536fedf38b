// A fraction that varies along a line.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "base/core/vec3.hpp"

namespace pliant {

/// `shares` are evenly spaced samples from `from` to `to`, linear in between and constant on planes normal to the line;
/// beyond the ends the end values hold. Preconditions: at least two shares, `from` is not `to`.
inline double share_along(std::span<const double> shares, const Vec3& from, const Vec3& to, const Vec3& place) {
    const Vec3 way = to - from;
    const double along = std::clamp(dot(place - from, way) / dot(way, way), 0.0, 1.0);
    const double at = along * static_cast<double>(shares.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(at), shares.size() - 2);
    return shares[i] + (shares[i + 1] - shares[i]) * (at - static_cast<double>(i));
}

}  // namespace pliant
