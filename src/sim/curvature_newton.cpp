#include <algorithm>

#include "linalg/cholesky.hpp"
#include "sim/curvature.hpp"
#include "sim/elements.hpp"

namespace pliant::sim {
namespace {

class Newton final : public Curvature {
public:
    explicit Newton(const Equilibrium& system)
        : system_(&system), pattern_(make_stiffness_pattern(system)), factor_(pattern_) {}

    [[nodiscard]] std::string_view name() const override { return "newton"; }
    [[nodiscard]] int default_iteration_limit() const override { return 100; }

    /// The tangent itself or, where it is not positive definite, as much of its positive projection as it takes: a
    /// little keeps the direction in which the body wants to buckle, all of it is safe but slow.
    [[nodiscard]] bool refresh(const State& state, bool cautious) override {
        assemble(state, false, values_);
        if (!cautious && factor_.factorise(values_)) {
            share_ = smallest_share;
            return true;
        }
        assemble(state, true, projected_);
        for (double share = cautious ? 1 : std::max(0.5 * share_, smallest_share);; share = std::min(2 * share, 1.0)) {
            blended_.resize(values_.size());
            for (std::size_t k = 0; k < values_.size(); ++k)
                blended_[k] = values_[k] + share * (projected_[k] - values_[k]);
            if (factor_.factorise(blended_)) {
                share_ = share;
                return true;
            }
            if (share == 1) return false;
        }
    }

    void solve(Eigen::MatrixXd& columns) override {
        factor_.solve({columns.data(), static_cast<std::size_t>(columns.size())}, static_cast<int>(columns.cols()));
    }

private:
    static linalg::SymmetricPattern make_stiffness_pattern(const Equilibrium& system) {
        const Model& model = system.model();
        auto cliques = model.elements().cliques(model.free_index());
        for (const CablePath& cable : system.cables()) cable.append_cliques(model.free_index(), cliques);
        return linalg::make_pattern(model.free_count(), 3, cliques);
    }

    void assemble(const State& state, bool project, std::vector<double>& values) const {
        const Model& model = system_->model();
        const std::span<const double> x(state.x.data(), static_cast<std::size_t>(state.x.size()));
        values.assign(pattern_.entries(), 0.0);
        model.elements().add_tangent(x, model.free_index(), pattern_, values, project);
        for (std::size_t c = 0; c < system_->cables().size(); ++c) {
            const double tension = state.tension[static_cast<Eigen::Index>(c)];
            if (tension > 0) system_->cables()[c].add_hessian(x, tension, model.free_index(), pattern_, values);
        }
    }

    static constexpr double smallest_share = 1.0 / 16;

    const Equilibrium* system_;
    linalg::SymmetricPattern pattern_;
    std::vector<double> values_;     ///< tangent
    std::vector<double> projected_;  ///< its positive projection, where it was needed
    std::vector<double> blended_;
    double share_ = smallest_share;  ///< of the projection that was needed last
    linalg::Cholesky factor_;
};

}  // namespace

std::unique_ptr<Curvature> make_newton(const Equilibrium& system) {
    return std::make_unique<Newton>(system);
}

}  // namespace pliant::sim
