// Nonlinear least squares within bounds, where one trial costs a whole simulation and may fail.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>

#include "base/core/error.hpp"

namespace pliant::sim::identify {

struct LeastSquaresProblem {
    /// Residuals at u; nothing where there is no solution, which makes the next step shorter. An error ends the search.
    std::function<Result<std::optional<Eigen::VectorXd>>(const Eigen::VectorXd& u)> residuals;
    /// (residuals, unknowns) at the last u whose residuals were better than all before; called once for each.
    std::function<Result<Eigen::MatrixXd>()> jacobian;
    Eigen::VectorXd low, high;  ///< (unknowns) bounds, which may be infinite
    double longest_step = 1;    ///< of any unknown at once
    int most_trials = 100;
};

struct LeastSquaresEnd {
    Eigen::VectorXd u;
    Eigen::VectorXd residuals;
    Eigen::MatrixXd jacobian;  ///< there
    int trials = 0;            ///< residuals asked for
    bool converged = false;    ///< false: most_trials came first
};

/// From `start`, within the bounds. Each step minimises |r + J s|^2 + lambda |D s|^2 over the unknowns that are not
/// held by a bound, D the lengths of the columns of J; only a step that truly lessens |r|^2 is taken. Source: Levenberg
/// 1944, Marquardt 1963; More 1978 for D. Errors: none at the start; those of the problem.
[[nodiscard]] Result<LeastSquaresEnd> minimise(const LeastSquaresProblem& problem, const Eigen::VectorXd& start);

}  // namespace pliant::sim::identify
