// The residual of a state.
#pragma once

#include <cmath>
#include <limits>

namespace pliant::sim {

/// Out-of-balance force over the forces that balance, all in N; 0 within their `rounding`. Infinite if it is not a
/// number, which comparisons with a tolerance would not notice.
[[nodiscard]] inline double relative_residual(double unbalanced, double balancing, double rounding) {
    if (balancing <= 0 || unbalanced <= rounding) return 0;
    const double residual = unbalanced / balancing;
    return std::isnan(residual) ? std::numeric_limits<double>::infinity() : residual;
}

}  // namespace pliant::sim
