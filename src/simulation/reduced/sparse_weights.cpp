#include "simulation/reduced/sparse_weights.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::sim::reduced {
namespace {

constexpr double dependent = 1e-12;  // of a column's square: what is new in it counts as rounding

/// The columns in use, with the Cholesky factor of their products.
class ActiveSet {
public:
    ActiveSet(const Eigen::MatrixXd& columns, const Eigen::VectorXd& wanted) : columns_(columns), wanted_(wanted) {}

    [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(list_.size()); }
    [[nodiscard]] const std::vector<Eigen::Index>& list() const { return list_; }
    [[nodiscard]] const Eigen::VectorXd& weights() const { return weights_; }

    /// False: it depends linearly on those that are there.
    [[nodiscard]] bool add(Eigen::Index column) {
        list_.push_back(column);
        const bool added = append_row(size() - 1);
        if (!added) list_.pop_back();
        if (added) {
            weights_.conservativeResize(size());
            weights_[size() - 1] = 0;
        }
        return added;
    }

    /// Moves the weights to the least squares solution; columns whose weight would become negative leave on the way.
    void solve() {
        while (true) {
            const Eigen::VectorXd best = least_squares();
            double share = 1;
            for (Eigen::Index k = 0; k < size(); ++k) {
                if (!(best[k] > 0))
                    share = std::min(share, weights_[k] > 0 ? weights_[k] / (weights_[k] - best[k]) : 0);
            }
            weights_ += share * (best - weights_);
            if (share == 1 && (best.array() > 0).all()) return;
            drop(best);
        }
    }

    [[nodiscard]] Eigen::VectorXd residual() const {
        Eigen::VectorXd residual = wanted_;
        for (Eigen::Index k = 0; k < size(); ++k) residual -= weights_[k] * columns_.col(list_[k]);
        return residual;
    }

private:
    /// Row k of the factor, for the k-th column of the list.
    [[nodiscard]] bool append_row(Eigen::Index k) {
        if (factor_.rows() <= k) {
            const Eigen::Index larger = std::max<Eigen::Index>(64, 2 * (k + 1));
            factor_.conservativeResize(larger, larger);
            target_.conservativeResize(larger);
        }
        const auto column = columns_.col(list_[k]);
        for (Eigen::Index j = 0; j < k; ++j) {
            const double product =
                columns_.col(list_[j]).dot(column) - factor_.row(j).head(j).dot(factor_.row(k).head(j));
            factor_(k, j) = product / factor_(j, j);
        }
        const double square = column.squaredNorm(), left = square - factor_.row(k).head(k).squaredNorm();
        if (!(left > dependent * square)) return false;
        factor_(k, k) = std::sqrt(left);
        target_[k] = column.dot(wanted_);
        return true;
    }

    [[nodiscard]] Eigen::VectorXd least_squares() const {
        const auto lower = factor_.topLeftCorner(size(), size()).triangularView<Eigen::Lower>();
        Eigen::VectorXd x = lower.solve(target_.head(size()));
        return lower.transpose().solve(x);
    }

    /// Leaves out the columns that have no weight any more and should have less.
    void drop(const Eigen::VectorXd& best) {
        const double zero = 1e-14 * weights_.maxCoeff();
        std::vector<Eigen::Index> kept;
        std::vector<double> weights;
        for (Eigen::Index k = 0; k < size(); ++k) {
            if (!(best[k] > 0) && weights_[k] <= zero) continue;
            kept.push_back(list_[k]);
            weights.push_back(weights_[k]);
        }
        list_.clear();
        weights_.resize(0);
        for (std::size_t k = 0; k < kept.size(); ++k) {
            if (add(kept[k])) weights_[size() - 1] = weights[k];
        }
    }

    const Eigen::MatrixXd& columns_;
    const Eigen::VectorXd& wanted_;
    std::vector<Eigen::Index> list_;
    Eigen::VectorXd weights_;
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> factor_;  ///< lower triangle
    Eigen::VectorXd target_;
};

}  // namespace

SparseWeights sparse_weights(const Eigen::MatrixXd& columns, const Eigen::VectorXd& wanted, double error,
                             const std::function<bool(double error)>& go_on) {
    const Eigen::VectorXd lengths = columns.colwise().norm();
    std::vector<bool> closed(static_cast<std::size_t>(columns.cols()));
    ActiveSet active(columns, wanted);
    Eigen::VectorXd residual = wanted;
    const double whole = wanted.norm();
    double now = whole > 0 ? 1 : 0;
    while (now > error && active.size() < columns.cols()) {
        // The column that points most towards what is missing, whatever its length.
        const Eigen::VectorXd along = columns.transpose() * residual;
        Eigen::Index next = -1;
        double most = 0;
        for (Eigen::Index k = 0; k < columns.cols(); ++k) {
            if (closed[static_cast<std::size_t>(k)] || !(lengths[k] > 0)) continue;
            if (along[k] / lengths[k] > most) {
                most = along[k] / lengths[k];
                next = k;
            }
        }
        if (next < 0 || most <= 1e-15 * whole) break;
        closed[static_cast<std::size_t>(next)] = true;  // unless it leaves again, below
        if (!active.add(next)) continue;
        active.solve();
        residual = active.residual();
        const double before = now;
        now = residual.norm() / whole;
        if (go_on && !go_on(now)) break;
        if (now < before) {
            for (Eigen::Index k = 0; k < columns.cols(); ++k) closed[static_cast<std::size_t>(k)] = false;
            for (const Eigen::Index k : active.list()) closed[static_cast<std::size_t>(k)] = true;
        }
    }
    SparseWeights found;
    found.error = now;
    for (Eigen::Index k = 0; k < active.size(); ++k)
        found.weights.push_back(
            {static_cast<std::size_t>(active.list()[static_cast<std::size_t>(k)]), active.weights()[k]});
    std::ranges::sort(found.weights, {}, &Weight::column);
    return found;
}

}  // namespace pliant::sim::reduced
