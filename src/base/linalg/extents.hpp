// How far an array of points reaches, and an array of motions goes.
#pragma once

#include <Eigen/Core>
#include <span>

namespace pliant::linalg {

/// Diagonal of the bounding box of points (3n); 0 of none.
[[nodiscard]] inline double diagonal(std::span<const double> points) {
    if (points.empty()) return 0;
    const Eigen::Map<const Eigen::Matrix3Xd> columns(points.data(), 3, static_cast<Eigen::Index>(points.size()) / 3);
    return (columns.rowwise().maxCoeff() - columns.rowwise().minCoeff()).norm();
}

/// Length of the longest of some vectors (3n); 0 of none.
[[nodiscard]] inline double longest(std::span<const double> vectors) {
    if (vectors.empty()) return 0;
    const Eigen::Map<const Eigen::Matrix3Xd> columns(vectors.data(), 3, static_cast<Eigen::Index>(vectors.size()) / 3);
    return columns.colwise().norm().maxCoeff();
}

}  // namespace pliant::linalg
