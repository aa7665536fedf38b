#include <utility>

#include "base/linalg/cholesky.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/solver/curvature.hpp"

namespace pliant::sim {

struct FactoredLaplacian::State {
    const Model* model;
    std::shared_ptr<const TangentLayout> layout;
    linalg::Cholesky factor;
};

namespace {

/// The thesis' iteration: every tet's target shape against the current one, reconciled by the constant matrix.
class LocalGlobal final : public Curvature {
public:
    explicit LocalGlobal(const FactoredLaplacian& laplacian) : laplacian_(&laplacian) {}
    [[nodiscard]] Solver solver() const override { return Solver::local_global; }
    [[nodiscard]] int default_iteration_limit() const override { return 20000; }
    [[nodiscard]] bool refresh(const sim::State&, const Controls&, TangentChoice choice, Errors) override {
        return choice != TangentChoice::exact;
    }
    void solve(Eigen::MatrixXd& columns) override { laplacian_->solve(columns); }

private:
    const FactoredLaplacian* laplacian_;
};

}  // namespace

FactoredLaplacian::FactoredLaplacian(const Equilibrium& system) {
    const Model& model = system.model();
    auto layout = std::make_shared<const TangentLayout>(system.lay_out_tangent());
    linalg::SymmetricPattern scalar = layout->pattern;
    scalar.block = 1;
    std::vector<double> values(scalar.entries(), 0.0);
    model.elements().add_laplacian(layout->element_sums, values);
    for (const Actuator& actuator : system.actuators()) {
        if (actuator.gaps() != nullptr) actuator.gaps()->add_laplacian(model.free_index(), scalar, values);
    }
    // It knows no directions: a node that is held in some of them is held a little in all, so that the body is held.
    for (const FreeRoller& roller : system.rollers()) {
        double& diagonal = values[static_cast<std::size_t>(scalar.node_start[static_cast<std::size_t>(roller.free)])];
        diagonal *= 1 + (3 - roller.may_move.trace()) / 3;
    }
    state_ = std::make_unique<State>(State{&model, std::move(layout), linalg::Cholesky(scalar)});
    // Positive definite by construction: every piece is held (Model::create) and every weight is positive.
    [[maybe_unused]] const bool done = state_->factor.factorise(values);
    state_->factor.release_work_space();
}

FactoredLaplacian::FactoredLaplacian(FactoredLaplacian&&) noexcept = default;
FactoredLaplacian::~FactoredLaplacian() = default;

const std::shared_ptr<const TangentLayout>& FactoredLaplacian::tangent_layout() const {
    return state_->layout;
}

const std::shared_ptr<const linalg::Analysis>& FactoredLaplacian::analysis() const {
    return state_->factor.analysis();
}

double FactoredLaplacian::work() const {
    return state_->factor.factor_work();
}

void FactoredLaplacian::solve(Eigen::Ref<Eigen::MatrixXd> columns) const {
    state_->factor.solve_fields({columns.data(), static_cast<std::size_t>(columns.size())},
                                static_cast<int>(columns.cols()));
}

Eigen::VectorXd FactoredLaplacian::follow(const Equilibrium& system, const Eigen::VectorXd& support_motion) const {
    Eigen::VectorXd coupling = Eigen::VectorXd::Zero(support_motion.size());
    state_->model->elements().apply_laplacian({support_motion.data(), static_cast<std::size_t>(support_motion.size())},
                                              {coupling.data(), static_cast<std::size_t>(coupling.size())});
    Eigen::VectorXd motion = -system.restrict_to_free(coupling);
    if (!system.rollers().empty()) return follow_on_rollers(system, motion);
    solve(motion);
    return motion;
}

/// Conjugate gradients on the Laplacian of what may move, with the factor as preconditioner.
Eigen::VectorXd FactoredLaplacian::follow_on_rollers(const Equilibrium& system, const Eigen::VectorXd& forces) const {
    constexpr int most_rounds = 60;
    constexpr double enough = 1e-3;
    const auto multiply = [&](const Eigen::VectorXd& v) {
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(3 * state_->model->node_count()), force = motion;
        system.add_free(v, 1, motion);
        state_->model->elements().apply_laplacian({motion.data(), static_cast<std::size_t>(motion.size())},
                                                  {force.data(), static_cast<std::size_t>(force.size())});
        return system.restrict_to_free(force);
    };
    const auto precondition = [&](const Eigen::VectorXd& force) {
        Eigen::VectorXd motion = force;
        solve(motion);
        for (const FreeRoller& roller : system.rollers())
            motion.segment<3>(3 * roller.free) = (roller.may_move * motion.segment<3>(3 * roller.free)).eval();
        return motion;
    };
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(forces.size()), left = forces;
    Eigen::VectorXd better = precondition(left), direction = better;
    double size = left.dot(better);
    const double wanted = enough * enough * size;
    for (int round = 0; round < most_rounds && size > wanted && size > 0; ++round) {
        const Eigen::VectorXd force = multiply(direction);
        const double share = size / direction.dot(force);
        sum += share * direction;
        left -= share * force;
        better = precondition(left);
        const double before = std::exchange(size, left.dot(better));
        direction = better + (size / before) * direction;
    }
    return sum;
}

Eigen::VectorXd FactoredLaplacian::rotate(const Equilibrium& system, const RotatingStep& rotating) const {
    Eigen::VectorXd end = Eigen::Map<const Eigen::VectorXd>(rotating.end, 3 * state_->model->node_count());
    Eigen::VectorXd turned = Eigen::VectorXd::Zero(end.size());
    state_->model->elements().add_rotation_term(rotating, {turned.data(), static_cast<std::size_t>(turned.size())});
    Eigen::VectorXd correction = system.restrict_to_free(turned);
    solve(correction);
    system.add_free(correction, 1, end);
    return end;
}

std::unique_ptr<Curvature> make_local_global(const FactoredLaplacian& laplacian) {
    return std::make_unique<LocalGlobal>(laplacian);
}

}  // namespace pliant::sim
