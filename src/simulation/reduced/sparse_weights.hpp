// Non-negative least squares with few unknowns above zero.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

namespace pliant::sim::reduced {

struct Weight {
    std::size_t column = 0;
    double weight = 0;  ///< above zero
    bool operator==(const Weight&) const = default;
};

struct SparseWeights {
    std::vector<Weight> weights;  ///< ascending by column
    double error = 0;             ///< |columns w - wanted| / |wanted|
};

/// Weights of columns (rows, count) that add up to `wanted` (rows) within `error` of its norm, or as near as
/// non-negative weights come: the active-set method of Lawson and Hanson (1974, Solving Least Squares Problems, ch.
/// 23), stopped as soon as that is reached. `go_on` is called with the error after each column; false ends the search.
[[nodiscard]] SparseWeights sparse_weights(const Eigen::MatrixXd& columns, const Eigen::VectorXd& wanted, double error,
                                           const std::function<bool(double error)>& go_on = {});

}  // namespace pliant::sim::reduced
