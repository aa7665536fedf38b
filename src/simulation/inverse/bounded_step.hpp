// The step within bounds that makes a linearised sum of squares small, by products with the Jacobian and its transpose
// alone.
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

/// Minimises |residuals + J step|^2 / 2 over lower <= step <= upper by conjugate gradients over the entries that are
/// free; those that meet a bound are fixed there, and let go again once the rest is solved and the gradient leads them
/// inwards (Polyak 1969; Moré and Toraldo 1991). Ends where the projected gradient is below `tolerance` times the first
/// one, or where residuals of no more than `enough` are left. Without bounds in the way it is the least of all steps
/// that are as good. Precondition: lower <= 0 <= upper.
[[nodiscard]] BoundedStep bounded_step(const Eigen::VectorXd& residuals, const Product& multiply,
                                       const Product& multiply_transposed, const Eigen::VectorXd& lower,
                                       const Eigen::VectorXd& upper, double tolerance, double enough = 0);

}  // namespace pliant::sim::inverse
