#include <cmath>
#include <deque>
#include <vector>

#include "sim/curvature.hpp"

namespace pliant::sim {
namespace {

constexpr std::size_t history = 10;

/// L-BFGS with the pre-factored Laplacian as initial matrix (two-loop recursion: Nocedal and Wright, algorithm 7.4).
class QuasiNewton final : public Curvature {
public:
    explicit QuasiNewton(const FactoredLaplacian& laplacian) : laplacian_(&laplacian) {}
    [[nodiscard]] Solver solver() const override { return Solver::quasi_newton; }
    [[nodiscard]] int default_iteration_limit() const override { return 3000; }
    void restart() override { pairs_.clear(); }

    [[nodiscard]] bool refresh(const State&, const Controls&, bool cautious) override {
        if (cautious) pairs_.clear();  // the last steps misled: start from the Laplacian again
        return true;
    }

    void solve(Eigen::MatrixXd& columns) override {
        for (Eigen::Index k = 0; k < columns.cols(); ++k) {
            Eigen::VectorXd q = columns.col(k);
            std::vector<double> alpha(pairs_.size());
            for (std::size_t i = pairs_.size(); i-- > 0;) {
                alpha[i] = pairs_[i].rho * pairs_[i].step.dot(q);
                q -= alpha[i] * pairs_[i].change;
            }
            laplacian_->solve(q);
            if (!pairs_.empty()) q *= pairs_.back().scale;
            for (std::size_t i = 0; i < pairs_.size(); ++i) {
                const double beta = pairs_[i].rho * pairs_[i].change.dot(q);
                q += (alpha[i] - beta) * pairs_[i].step;
            }
            columns.col(k) = q;
        }
    }

    void learn(const Eigen::VectorXd& step, const Eigen::VectorXd& change) override {
        const double curvature = step.dot(change);
        if (!(curvature > 1e-10 * step.norm() * change.norm())) return;  // would make H indefinite
        Eigen::VectorXd smoothed = change;
        laplacian_->solve(smoothed);
        pairs_.push_back({step, change, 1 / curvature, curvature / change.dot(smoothed)});
        if (pairs_.size() > history) pairs_.pop_front();
    }

private:
    struct Pair {
        Eigen::VectorXd step;
        Eigen::VectorXd change;
        double rho;    ///< 1 / (step . change)
        double scale;  ///< fits the Laplacian to the stiffness met in this step
    };
    const FactoredLaplacian* laplacian_;
    std::deque<Pair> pairs_;
};

}  // namespace

std::unique_ptr<Curvature> make_quasi_newton(const FactoredLaplacian& laplacian) {
    return std::make_unique<QuasiNewton>(laplacian);
}

}  // namespace pliant::sim
