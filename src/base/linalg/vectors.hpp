// Points and arrays of points as Eigen types.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::linalg {

[[nodiscard]] inline Eigen::Vector3d vector(const Vec3& v) {
    return {v.x, v.y, v.z};
}

/// A point of an array (3n), without a copy: the array must outlive the view.
[[nodiscard]] inline Eigen::Map<const Eigen::Vector3d> view(std::span<const double> points, int point) {
    return Eigen::Map<const Eigen::Vector3d>(points.data() + 3 * static_cast<std::size_t>(point));
}

/// All numbers of a vector, or of a matrix column by column, without a copy: it must outlive the view.
[[nodiscard]] inline std::span<const double> view(const Eigen::VectorXd& v) {
    return {v.data(), static_cast<std::size_t>(v.size())};
}
[[nodiscard]] inline std::span<double> view(Eigen::VectorXd& v) {
    return {v.data(), static_cast<std::size_t>(v.size())};
}
[[nodiscard]] inline std::span<const double> view(const Eigen::MatrixXd& m) {
    return {m.data(), static_cast<std::size_t>(m.size())};
}
[[nodiscard]] inline std::span<double> view(Eigen::MatrixXd& m) {
    return {m.data(), static_cast<std::size_t>(m.size())};
}

/// The points of an array (3n).
[[nodiscard]] inline std::vector<Vec3> points_of(const Eigen::VectorXd& x) {
    std::vector<Vec3> points;
    points.reserve(static_cast<std::size_t>(x.size()) / 3);
    for (Eigen::Index k = 0; k + 2 < x.size(); k += 3) points.push_back({x[k], x[k + 1], x[k + 2]});
    return points;
}

}  // namespace pliant::linalg
