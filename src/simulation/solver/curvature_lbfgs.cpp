#include "simulation/solver/curvature.hpp"
#include "simulation/solver/step_memory.hpp"

namespace pliant::sim {
namespace {

constexpr std::size_t history = 10;

/// L-BFGS with the pre-factored Laplacian as initial matrix.
class QuasiNewton final : public Curvature {
public:
    explicit QuasiNewton(const FactoredLaplacian& laplacian) : laplacian_(&laplacian), memory_(history) {}
    [[nodiscard]] Solver solver() const override { return Solver::quasi_newton; }
    [[nodiscard]] int default_iteration_limit() const override { return 3000; }
    void restart() override { memory_.clear(); }

    [[nodiscard]] bool refresh(const State&, const Controls&, TangentChoice choice, Errors) override {
        if (choice == TangentChoice::exact) return false;         // no better choice is available
        if (choice == TangentChoice::projected) memory_.clear();  // the last steps misled: restart from the Laplacian
        return true;
    }

    void solve(Eigen::MatrixXd& columns) override {
        memory_.apply(columns, [&](Eigen::MatrixXd& c) { laplacian_->solve(c); });
    }

    void learn(const Eigen::VectorXd& step, const Eigen::VectorXd& change) override {
        Eigen::VectorXd smoothed = change;
        laplacian_->solve(smoothed);
        // Scales the Laplacian to the stiffness observed in this step.
        memory_.learn(step, change, step.dot(change) / change.dot(smoothed));
    }

private:
    const FactoredLaplacian* laplacian_;
    StepMemory memory_;
};

}  // namespace

std::unique_ptr<Curvature> make_quasi_newton(const FactoredLaplacian& laplacian) {
    return std::make_unique<QuasiNewton>(laplacian);
}

}  // namespace pliant::sim
