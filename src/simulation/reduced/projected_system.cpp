#include "simulation/reduced/projected_system.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "base/linalg/sparse.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/reduced/sampled_robot.hpp"

namespace pliant::sim::reduced {
namespace {

constexpr int most_changes_of_slack = 8;

}  // namespace

Controls controls_at(const Equilibrium& system, const Inputs& inputs) {
    Controls controls = system.controls(inputs.time);
    std::ranges::copy(inputs.drives, controls.drives.begin());
    return controls;
}

Result<ProjectedModel> ProjectedModel::create(const Description& whole, const Eigen::Ref<const Eigen::MatrixXd>& modes,
                                              const std::vector<Weight>& tets) {
    SampledRobot sampled = sampled_robot(whole, tets);
    const auto nodes = static_cast<Eigen::Index>(sampled.nodes.size());
    ProjectedModel made;
    made.modes_.resize(3 * nodes, modes.cols());
    made.rest_.resize(3 * nodes);
    for (Eigen::Index k = 0; k < nodes; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const Attachment& moves_with = sampled.nodes[at];
        made.modes_.middleRows<3>(3 * k).setZero();
        for (std::size_t i = 0; i < moves_with.nodes.size(); ++i)
            made.modes_.middleRows<3>(3 * k) +=
                moves_with.weights[i] * modes.middleRows<3>(3 * static_cast<Eigen::Index>(moves_with.nodes[i]));
        made.rest_.segment<3>(3 * k) = linalg::vector(sampled.description.mesh.points[at]);
    }
    Result<Model> model = Model::create(std::move(sampled.description));
    if (!model) return tl::unexpected(model.error());
    made.model_ = std::make_unique<Model>(std::move(*model));
    made.system_ = std::make_unique<Equilibrium>(*made.model_);
    made.layout_ = std::make_unique<TangentLayout>(made.system_->lay_out_tangent({}, TangentNodes::all));
    return made;
}

ProjectedTangent::ProjectedTangent(const ProjectedModel& model)
    : model_(&model),
      stiffness_(model.layout().pattern.entries()),
      products_(model.modes().rows(), model.modes().cols()) {
    const Equilibrium& system = model.system();
    if (system.has_skew() || system.has_torques() || !system.model().elements().has_energy())
        skew_.resize(model.layout().pattern.entries());
}

void ProjectedTangent::assemble(const State& state, const Evaluation& evaluation, const Controls& controls) {
    const Equilibrium& system = model_->system();
    std::ranges::fill(stiffness_, 0.0);
    system.add_tangent(state, controls, model_->layout(), stiffness_, false);
    products_.setZero();
    add_block_products(stiffness_, false);
    if (!skew_.empty()) {
        std::ranges::fill(skew_, 0.0);
        system.add_skew(state, controls, model_->layout(), skew_);
        add_block_products(skew_, true);
    }
    reduced_.noalias() = model_->modes().transpose() * products_;
    mean_stiffness_ = std::max(reduced_.diagonal().cwiseAbs().mean(), 1e-300);
    multipliers_ = evaluation.multiplier;
    driven_.clear();
    for (std::size_t a = 0; a < controls.drives.size(); ++a) {
        if (controls.drives[a].kind == Drive::Kind::measure) add_constraint(a, state, evaluation);
        if (controls.drives[a].kind != Drive::Kind::gas) continue;
        // m = p_ambient - value / g, so that dm/dg = value / g^2.
        const double measure = system.actuators()[a].measure(linalg::view(state.x));
        const Eigen::VectorXd along = gradient(a, state.x);
        reduced_ += controls.drives[a].value / (measure * measure) * along * along.transpose();
    }
}

void ProjectedTangent::add_constraint(std::size_t actuator, const State& state, const Evaluation& evaluation) {
    const Actuator& measured = model_->system().actuators()[actuator];
    const auto at = static_cast<Eigen::Index>(actuator);
    Constraint one{at,
                   measured.only_pulls(),
                   evaluation.constraint_violation[at] * measured.rest_measure(),
                   evaluation.multiplier[at],
                   1,
                   gradient(actuator, state.x)};
    const double length = one.gradient.norm();
    if (length > 0) one.scale = mean_stiffness_ / length;
    driven_.push_back(std::move(one));
}

Eigen::VectorXd ProjectedTangent::gradient(std::size_t actuator, const Eigen::VectorXd& x) const {
    Eigen::VectorXd full = Eigen::VectorXd::Zero(x.size());
    model_->system().actuators()[actuator].add_measure_gradient(linalg::view(x), 1, linalg::view(full));
    return model_->modes().transpose() * full;
}

/// products += K V for the blocks of a pattern that stores those at and below the diagonal.
void ProjectedTangent::add_block_products(const std::vector<double>& values, bool skew) {
    const linalg::SymmetricPattern& p = model_->layout().pattern;
    const ProjectedModel::Rows& modes = model_->modes();
    const double sign = skew ? -1 : 1;
    for (int j = 0; j < p.nodes; ++j) {
        const auto of_j = modes.middleRows<3>(3 * static_cast<Eigen::Index>(j));
        auto on_j = products_.middleRows<3>(3 * static_cast<Eigen::Index>(j));
        for (int k = p.node_start[j]; k < p.node_start[j + 1]; ++k) {
            const Eigen::Map<const Eigen::Matrix3d> block(values.data() + 9 * static_cast<std::size_t>(k));
            const Eigen::Index i = p.node_row[k];
            if (i == j && !skew) {
                const Eigen::Matrix3d whole = block.selfadjointView<Eigen::Lower>();
                on_j.noalias() += whole.lazyProduct(of_j);
            } else if (i == j) {
                on_j.noalias() += block.lazyProduct(of_j);
            } else {
                products_.middleRows<3>(3 * i).noalias() += block.lazyProduct(of_j);
                on_j.noalias() += sign * block.transpose().lazyProduct(modes.middleRows<3>(3 * i));
            }
        }
    }
}

/// (modes, driven) the change of the amplitudes and the new multipliers, scaled. `balance`: out-of-balance forces
/// without those of the driven actuators.
Eigen::VectorXd ProjectedTangent::solved(const std::vector<bool>& taut, const Eigen::VectorXd& balance) const {
    const Eigen::Index modes = reduced_.rows(), count = static_cast<Eigen::Index>(driven_.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(modes + count, modes + count);
    Eigen::VectorXd right(modes + count);
    matrix.topLeftCorner(modes, modes) = reduced_;
    right.head(modes) = -balance;
    for (Eigen::Index k = 0; k < count; ++k) {
        const Constraint& one = driven_[static_cast<std::size_t>(k)];
        matrix.col(modes + k).head(modes) = one.scale * one.gradient;
        if (taut[static_cast<std::size_t>(k)]) {
            matrix.row(modes + k).head(modes) = one.scale * one.gradient.transpose();
            right[modes + k] = -one.scale * one.violation;
        } else {
            matrix(modes + k, modes + k) = mean_stiffness_;
            right[modes + k] = 0;
        }
    }
    return matrix.partialPivLu().solve(right);
}

std::optional<Projected> ProjectedTangent::step(const Eigen::VectorXd& forces) const {
    const Eigen::Index modes = reduced_.rows();
    // What multipliers do is part of the balance: their new values, not their changes, are the unknowns.
    Eigen::VectorXd balance = forces;
    std::vector<bool> taut;
    for (const Constraint& one : driven_) {
        balance -= one.multiplier * one.gradient;
        taut.push_back(!one.only_pulls || one.multiplier > 0 || one.violation > 0);
    }
    Eigen::VectorXd solution;
    bool settled = false;
    for (int round = 0; !settled && round <= most_changes_of_slack; ++round) {
        solution = solved(taut, balance);
        if (!solution.allFinite()) return std::nullopt;
        settled = true;
        for (std::size_t k = 0; k < driven_.size(); ++k) {
            const Constraint& one = driven_[k];
            if (!one.only_pulls) continue;
            const bool changes = taut[k] ? solution[modes + static_cast<Eigen::Index>(k)] < 0
                                         : one.violation + one.gradient.dot(solution.head(modes)) > 0;
            if (!changes) continue;
            taut[k] = !taut[k];
            settled = false;
        }
    }
    Projected next{solution.head(modes), multipliers_};
    for (std::size_t k = 0; k < driven_.size(); ++k) {
        const Constraint& one = driven_[k];
        const double multiplier = one.scale * solution[modes + static_cast<Eigen::Index>(k)];
        next.multipliers[one.actuator] = one.only_pulls ? std::max(multiplier, 0.0) : multiplier;
    }
    return next;
}

}  // namespace pliant::sim::reduced
