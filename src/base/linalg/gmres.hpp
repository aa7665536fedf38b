// Iterative solution of systems that are not symmetric.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace pliant::linalg {

/// Solves A x = b for a matrix that is given by its product, starting from zero, without restarts. Stops at
/// |b - A x| <= tolerance |b| or after `limit` products, with the best x so far. To precondition from the right by
/// M^-1, give the product A M^-1 and take M^-1 of the result. Source: Saad and Schultz 1986.
[[nodiscard]] Eigen::VectorXd gmres(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& multiply,
                                    const Eigen::VectorXd& b, double tolerance, int limit);

}  // namespace pliant::linalg
