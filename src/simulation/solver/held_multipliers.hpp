// Which cables pull, and how hard: the multipliers of constraints of which some hold in one direction alone.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace pliant::sim {

/// The multipliers m that solve min m^T S m / 2 - m^T b, where those that `only_pull` may not be negative: each cable
/// either pulls and keeps its length, or is slack and not too long. S = A^T H^-1 A may be singular (parallel cables).
/// Lawson and Hanson 1974, chapter 23.
[[nodiscard]] Eigen::VectorXd multipliers_that_hold(const Eigen::MatrixXd& S, const Eigen::VectorXd& b,
                                                    const std::vector<bool>& only_pull);

}  // namespace pliant::sim
