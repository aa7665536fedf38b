// Nonlinear least squares with bounds, for functions that cost a whole simulation and may fail.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>

#include "base/core/error.hpp"

namespace pliant::sim::identify {

struct LeastSquaresProblem {
    /// Residuals at u; empty if there is no solution there, which makes the next step shorter. An error ends the
    /// search.
    std::function<Result<std::optional<Eigen::VectorXd>>(const Eigen::VectorXd& u)> residuals;
    /// (residuals, unknowns) Jacobian at the last u that improved on all earlier ones; called once for each such u.
    std::function<Result<Eigen::MatrixXd>()> jacobian;
    Eigen::VectorXd low, high;  ///< (unknowns) bounds, possibly infinite
    double longest_step = 1;    ///< largest change of any unknown in one step
    int most_trials = 100;
};

struct LeastSquaresEnd {
    Eigen::VectorXd u;
    Eigen::VectorXd residuals;
    Eigen::MatrixXd jacobian;  ///< at the solution
    int trials = 0;            ///< number of evaluations of the residuals
    bool converged = false;    ///< false: the limit most_trials was reached
};

/// Starts from `start`, within the bounds. Each step minimises |r + J s|^2 + lambda |D s|^2 over the unknowns that are
/// not held at a bound, with D the norms of the columns of J; a step is accepted only if it decreases |r|^2. Source:
/// Levenberg 1944, Marquardt 1963; More 1978 for D. Errors: no residuals at the start; those of the problem.
[[nodiscard]] Result<LeastSquaresEnd> minimise(const LeastSquaresProblem& problem, const Eigen::VectorXd& start);

}  // namespace pliant::sim::identify
