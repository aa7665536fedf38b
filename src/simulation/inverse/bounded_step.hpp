// The step within bounds that minimises a linearised sum of squares, using only products with the Jacobian and its
// transpose.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace pliant::sim::inverse {

using Product = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

struct BoundedStep {
    Eigen::VectorXd step;      ///< (inputs)
    Eigen::VectorXd change;    ///< (rows) J step
    Eigen::VectorXd gradient;  ///< (inputs) J^T residuals, before the step
    double decrease = 0;       ///< of half the sum of squares; not negative
};

/// Minimises |residuals + J step|^2 / 2 over lower <= step <= upper by conjugate gradients on the free entries; entries
/// that reach a bound are fixed there, and released once the rest is solved if the gradient points inwards (Polyak
/// 1969; Moré and Toraldo 1991). Stops when the projected gradient is below `tolerance` times the first one, or the
/// residuals are at most `enough`. If no bound is active, the result is the minimum-norm step. Precondition: lower <= 0
/// <= upper.
[[nodiscard]] BoundedStep bounded_step(const Eigen::VectorXd& residuals, const Product& multiply,
                                       const Product& multiply_transposed, const Eigen::VectorXd& lower,
                                       const Eigen::VectorXd& upper, double tolerance, double enough = 0);

}  // namespace pliant::sim::inverse
