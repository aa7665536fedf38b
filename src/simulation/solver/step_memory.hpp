// L-BFGS updates of a given matrix from the last steps.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

namespace pliant::sim {

/// One step, and the resulting change of force.
struct StepPair {
    Eigen::VectorXd step;
    Eigen::VectorXd change;
    double rho = 0;  ///< 1 / (step . change)
    double scale = 1;
};

/// L-BFGS: the inverse of a matrix H, updated with the last steps and their changes of force (two-loop recursion:
/// Nocedal and Wright, Numerical Optimization, algorithm 7.4).
class StepMemory {
public:
    explicit StepMemory(std::size_t most) : most_(most) {}

    void clear() { pairs_.clear(); }
    [[nodiscard]] bool empty() const { return pairs_.empty(); }

    /// `scale` multiplies H^-1 from here on. Steps with non-positive curvature are skipped: they would make the matrix
    /// indefinite.
    void learn(const Eigen::VectorXd& step, const Eigen::VectorXd& change, double scale = 1) {
        const double curvature = step.dot(change);
        if (!(curvature > 1e-10 * step.norm() * change.norm())) return;
        pairs_.push_back(std::make_shared<const StepPair>(StepPair{step, change, 1 / curvature, scale}));
        if (pairs_.size() > most_) pairs_.pop_front();
    }

    /// columns <- updated H^-1 columns, where `solve` applies H^-1 to all of them in place.
    template <class Solve>
    void apply(Eigen::MatrixXd& columns, const Solve& solve) const {
        Eigen::MatrixXd alpha(static_cast<Eigen::Index>(pairs_.size()), columns.cols());
        for (std::size_t i = pairs_.size(); i-- > 0;) {
            const auto row = static_cast<Eigen::Index>(i);
            alpha.row(row) = pairs_[i]->rho * (pairs_[i]->step.transpose() * columns);
            columns.noalias() -= pairs_[i]->change * alpha.row(row);
        }
        solve(columns);
        if (!pairs_.empty() && pairs_.back()->scale != 1) columns *= pairs_.back()->scale;
        for (std::size_t i = 0; i < pairs_.size(); ++i) {
            const Eigen::RowVectorXd beta = pairs_[i]->rho * (pairs_[i]->change.transpose() * columns);
            columns.noalias() += pairs_[i]->step * (alpha.row(static_cast<Eigen::Index>(i)) - beta);
        }
    }

    using Pairs = std::vector<std::shared_ptr<const StepPair>>;
    [[nodiscard]] Pairs pairs() const { return {pairs_.begin(), pairs_.end()}; }
    void set_pairs(const Pairs& pairs) { pairs_.assign(pairs.begin(), pairs.end()); }

private:
    std::size_t most_;
    std::deque<std::shared_ptr<const StepPair>> pairs_;
};

}  // namespace pliant::sim
