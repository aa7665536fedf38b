// Conjugate gradients with linear constraints, for TwoLevel::solve_constrained().
#pragma once

#include <span>

#include "base/linalg/coarse_quality.hpp"
#include "base/linalg/smoothed_levels.hpp"
#include "base/linalg/two_level.hpp"

namespace pliant::linalg {

/// See TwoLevel::solve_constrained(). `iterations`: += those that it took. Slow also where a rotated coarse level is
/// outdated; nothing is changed then.
[[nodiscard]] TwoLevel::Outcome project_gradients(SmoothedLevels& levels, CoarseQuality& quality,
                                                  std::span<double> right_hand_side,
                                                  const TwoLevel::Constraints& constraints,
                                                  std::span<double> multipliers, double tolerance, int limit,
                                                  int& iterations);

}  // namespace pliant::linalg
