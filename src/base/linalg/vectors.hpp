// Points and arrays of points as Eigen takes them.
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/core/vec3.hpp"

namespace pliant::linalg {

[[nodiscard]] inline Eigen::Vector3d vector(const Vec3& v) {
    return {v.x, v.y, v.z};
}

/// Three numbers of an array of points (3n), without a copy: the array must outlive the view.
[[nodiscard]] inline Eigen::Map<const Eigen::Vector3d> view(std::span<const double> points, int point) {
    return Eigen::Map<const Eigen::Vector3d>(points.data() + 3 * static_cast<std::size_t>(point));
}

}  // namespace pliant::linalg
