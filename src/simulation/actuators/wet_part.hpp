// The part of a flat triangle that lies below the level of a fluid, and what the depth integrates to over it: exactly,
// as the depth is linear.
#pragma once

#include <array>

#include "base/linalg/small.hpp"

namespace pliant::sim {

/// Depths of a triangle's corners below the level, m; negative above it.
using Depths = std::array<double, 3>;

/// Mean of d^2/2 over a triangle, with d the depth, zero above the level, and its derivatives by the corners' depths.
/// Twice continuously differentiable, except where an edge lies in the level.
struct MeanSquare {
    double value = 0;
    linalg::Vector3 first = linalg::Vector3::Zero();  ///< also the mean of d times each corner's barycentric coordinate
    linalg::Matrix3 second = linalg::Matrix3::Zero();
};

/// `is_cut`: what is above the level is left out. Otherwise the fluid has no surface, and all of the triangle counts.
[[nodiscard]] MeanSquare mean_square(const Depths& depths, bool is_cut);

/// Share of a triangle's area below the level.
[[nodiscard]] double wet_share(const Depths& depths);

}  // namespace pliant::sim
