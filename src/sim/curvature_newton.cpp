#include <algorithm>

#include "linalg/cholesky.hpp"
#include "sim/curvature.hpp"
#include "sim/elements.hpp"

namespace pliant::sim {
namespace {

class Newton final : public Curvature {
public:
    explicit Newton(const Equilibrium& system)
        : system_(&system), pattern_(make_stiffness_pattern(system)), values_(pattern_.entries()), factor_(pattern_) {}

    [[nodiscard]] std::string_view name() const override { return "newton"; }
    [[nodiscard]] int default_iteration_limit() const override { return 60; }

    [[nodiscard]] bool refresh(const State& state, bool cautious) override {
        return (!cautious && factorise(state, false)) || factorise(state, true);
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

    bool factorise(const State& state, bool project) {
        const Model& model = system_->model();
        const std::span<const double> x(state.x.data(), static_cast<std::size_t>(state.x.size()));
        std::fill(values_.begin(), values_.end(), 0.0);
        model.elements().add_tangent(x, model.free_index(), pattern_, values_, project);
        for (std::size_t c = 0; c < system_->cables().size(); ++c) {
            const double tension = state.tension[static_cast<Eigen::Index>(c)];
            if (tension > 0) system_->cables()[c].add_hessian(x, tension, model.free_index(), pattern_, values_);
        }
        return factor_.factorise(values_);
    }

    const Equilibrium* system_;
    linalg::SymmetricPattern pattern_;
    std::vector<double> values_;
    linalg::Cholesky factor_;
};

}  // namespace

std::unique_ptr<Curvature> make_newton(const Equilibrium& system) {
    return std::make_unique<Newton>(system);
}

}  // namespace pliant::sim
