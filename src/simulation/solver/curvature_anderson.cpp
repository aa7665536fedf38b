#include <Eigen/Core>
#include <cmath>
#include <deque>

#include "base/linalg/dense.hpp"
#include "simulation/solver/curvature.hpp"

namespace pliant::sim {
namespace {

constexpr std::size_t window = 8;  // 5 to 10 are usual; more costs dot products and keeps outdated steps

/// Anderson acceleration of the local-global iteration (Anderson 1965; for geometry Peng et al. 2018). A plain step is
/// -L^-1 f. For each of the last steps s_j the change of the force, y_j, and hence of the plain step, -L^-1 y_j, is
/// known. The linear combination that minimises the plain step,
///
///     gamma = argmin | L^-1 (f - sum gamma_j y_j) |_L ,      dx = -L^-1 (f - sum gamma_j y_j) - sum gamma_j s_j
///
/// is linear in f (Walker and Ni 2011, section 4; Fang and Saad 2009): it defines a matrix H^-1 with H^-1 y_j = s_j, so
/// that cables and chambers are included through A^T H^-1 A as in every other solver. In the norm of L the normal
/// equations only need L^-1 y_j, which a step computes anyway.
class Anderson final : public Curvature {
public:
    explicit Anderson(const FactoredLaplacian& laplacian) : laplacian_(&laplacian) {}
    [[nodiscard]] Solver solver() const override { return Solver::anderson; }
    [[nodiscard]] int default_iteration_limit() const override { return 5000; }
    void restart() override { steps_.clear(); }

    /// The accelerated step need not be a descent direction: if it is rejected, the plain step is used. The history is
    /// then discarded, or it would mislead every later iteration too, and all steps would be plain ones.
    [[nodiscard]] bool refresh(const State&, const Controls&, TangentChoice choice, Errors) override {
        if (choice == TangentChoice::exact) return false;  // no better choice is available
        if (choice == TangentChoice::projected) steps_.clear();
        mixing_ = !steps_.empty();
        if (mixing_) factorise();
        return true;
    }

    /// If it is not good at nearly full length, it is rejected: the plain step is available.
    [[nodiscard]] double smallest_share() const override { return mixing_ ? 0.2 : Curvature::smallest_share(); }

    void solve(Eigen::MatrixXd& columns) override {
        if (!mixing_) {
            laplacian_->solve(columns);
            return;
        }
        const auto count = static_cast<Eigen::Index>(steps_.size());
        for (Eigen::Index k = 0; k < columns.cols(); ++k) {
            Eigen::VectorXd products(count);
            for (Eigen::Index j = 0; j < count; ++j) products[j] = at(j).plain.dot(columns.col(k)) / at(j).size;
            const Eigen::VectorXd gamma = gram_inverse_ * products;
            Eigen::VectorXd plain = columns.col(k);
            laplacian_->solve(plain);
            for (Eigen::Index j = 0; j < count; ++j) plain += gamma[j] / at(j).size * (at(j).step - at(j).plain);
            columns.col(k) = plain;
        }
    }

    void learn(const Eigen::VectorXd& step, const Eigen::VectorXd& change) override {
        Eigen::VectorXd plain = change;
        laplacian_->solve(plain);
        const double size = std::sqrt(plain.dot(change));
        if (!(size > 0)) return;
        steps_.push_back({step, change, std::move(plain), size});
        if (steps_.size() > window) steps_.pop_front();
    }

private:
    struct Past {
        Eigen::VectorXd step;
        Eigen::VectorXd change;  ///< of the force, at fixed multipliers
        Eigen::VectorXd plain;   ///< L^-1 change
        double size;             ///< its norm in L, by which columns are scaled
    };
    [[nodiscard]] const Past& at(Eigen::Index j) const { return steps_[static_cast<std::size_t>(j)]; }

    /// Steps that are nearly linear combinations of others are dropped by rank.
    void factorise() {
        const auto count = static_cast<Eigen::Index>(steps_.size());
        Eigen::MatrixXd gram(count, count);
        for (Eigen::Index i = 0; i < count; ++i) {
            for (Eigen::Index j = 0; j <= i; ++j)
                gram(i, j) = gram(j, i) = at(i).plain.dot(at(j).change) / (at(i).size * at(j).size);
        }
        gram_inverse_ = linalg::pseudo_inverse(gram, 1e-10);
    }

    const FactoredLaplacian* laplacian_;
    std::deque<Past> steps_;
    Eigen::MatrixXd gram_inverse_;
    bool mixing_ = false;
};

}  // namespace

std::unique_ptr<Curvature> make_anderson(const FactoredLaplacian& laplacian) {
    return std::make_unique<Anderson>(laplacian);
}

}  // namespace pliant::sim
