// Iterative solution of non-symmetric systems.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace pliant::linalg {

/// Solves A x = b for a matrix given by its product, starting from zero, without restarts. Stops when
/// |b - A x| <= tolerance |b| or after `limit` products, with the best x so far. To precondition from the right by
/// M^-1, give the product A M^-1 and apply M^-1 to the result. Source: Saad and Schultz 1986.
[[nodiscard]] Eigen::VectorXd gmres(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& multiply,
                                    const Eigen::VectorXd& b, double tolerance, int limit);

}  // namespace pliant::linalg
