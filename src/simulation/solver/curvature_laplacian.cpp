#include <Eigen/Geometry>
#include <Eigen/LU>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/linalg/cholesky.hpp"
#include "base/linalg/factor_size.hpp"
#include "base/linalg/field_levels.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/solver/corner_nesting.hpp"
#include "simulation/solver/curvature.hpp"

namespace pliant::sim {

struct FactoredLaplacian::State {
    const Model* model = nullptr;
    std::shared_ptr<const TangentLayout> layout;
    std::mutex analysing;
    std::shared_ptr<const linalg::Analysis> analysis;  ///< null: not needed yet
    double work = 0;                                   ///< multiply-adds of a factorisation
    std::optional<linalg::Cholesky> factor;
    std::optional<linalg::FieldLevels> levels;  ///< in place of a factor
    std::vector<std::pair<int, double>> held;   ///< nodes of free pieces and objects, stiffness N/m
    /// Which object follows which joint, starting from what is held.
    struct Follower {
        std::size_t joint = 0;
        int object = 0;
        double sign = 1;  ///< of the joint's second thing; -1: of its first
    };
    std::vector<Follower> followers;

    void invert(const linalg::SymmetricPattern& pattern, const std::vector<double>& values, double most_entries);
};

namespace {

/// Relative error, in the energy norm, of solutions on several levels: far below what steps and directions need.
constexpr double levels_tolerance = 1e-6;

/// Stiffness that holds free pieces, relative to that of their nodes.
constexpr double small_hold = 1e-5;

/// End of the straight step of a node, including the past states.
Eigen::Vector3d straight_end(const RotatingStep& rotating, int node) {
    const auto at = [&](const double* x) {
        return Eigen::Map<const Eigen::Vector3d>(x + 3 * static_cast<std::size_t>(node));
    };
    Eigen::Vector3d end = at(rotating.end);
    const double* after = rotating.now;
    for (std::size_t k = 0; k < RotatingStep::most_past && rotating.past[k] != nullptr; ++k) {
        end += rotating.weights[k] * (at(after) - at(rotating.past[k]));
        after = rotating.past[k];
    }
    return end;
}

/// Applies the rotation of a straight step exactly: (1 + S + W) becomes exp(W) (1 + S), about the centre of mass.
void turn_object(const AffineBody& object, const RotatingStep& rotating, Eigen::VectorXd& end) {
    const std::span<const double> now(rotating.now, static_cast<std::size_t>(end.size()));
    for (const int node : object.nodes()) end.segment<3>(3 * node) = straight_end(rotating, node);
    const std::span<const double> straight = linalg::view(std::as_const(end));
    const linalg::Matrix3 change =
        object.deformation(straight) * object.deformation(now).inverse() - linalg::Matrix3::Identity();
    const linalg::Matrix3 spin = 0.5 * (change - change.transpose());
    const Eigen::Vector3d axis(spin(2, 1), spin(0, 2), spin(1, 0));
    const double angle = axis.norm();
    linalg::Matrix3 whole = linalg::Matrix3::Identity() + change - spin;
    if (angle > 1e-12) whole = (Eigen::AngleAxisd(angle, axis / angle).toRotationMatrix() * whole).eval();
    const linalg::Vector3 from = object.centre(now), to = object.centre(straight);
    for (const int node : object.nodes()) end.segment<3>(3 * node) = to + whole * (linalg::view(now, node) - from);
}

/// The rotation term does not determine the rigid motion of free pieces: they move with the mean of their nodes in the
/// straight step.
void carry_free_pieces(const Model& model, const RotatingStep& rotating, Eigen::VectorXd& end) {
    for (const std::vector<int>& piece : model.free_pieces()) {
        Eigen::Vector3d shift = Eigen::Vector3d::Zero();
        for (const int node : piece) shift += straight_end(rotating, node) - end.segment<3>(3 * node);
        shift /= static_cast<double>(piece.size());
        for (const int node : piece) end.segment<3>(3 * node) += shift;
    }
}

/// Visits every object once, after the one it is connected to; one of each closed group of objects stays where it is.
template <class Follower>
std::vector<Follower> order_of_joints(const Description& d) {
    std::vector<bool> known(d.objects.size(), false);
    const auto is_known = [&](int object) { return object < 0 || known[static_cast<std::size_t>(object)]; };
    std::vector<Follower> order;
    const auto follow = [&] {
        const std::size_t before = order.size();
        for (std::size_t j = 0; j < d.joints.size(); ++j) {
            const auto [first, second] = d.joints[j].objects;
            if (is_known(first) == is_known(second)) continue;
            const int object = is_known(first) ? second : first;
            order.push_back({j, object, is_known(first) ? 1.0 : -1.0});
            known[static_cast<std::size_t>(object)] = true;
        }
        return order.size() > before;
    };
    for (std::size_t root = 0; root <= known.size(); ++root) {
        while (follow()) {
        }
        if (root < known.size()) known[root] = true;
    }
    return order;
}

/// The thesis' iteration: the target shape of every tet is compared with the current one, made compatible by the
/// constant matrix.
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

FactoredLaplacian::FactoredLaplacian(const Equilibrium& system, double most_entries) {
    const Model& model = system.model();
    auto layout = std::make_shared<const TangentLayout>(system.lay_out_tangent());
    linalg::SymmetricPattern scalar = layout->pattern;
    scalar.block = 1;
    std::vector<double> values(scalar.entries(), 0.0);
    model.elements().add_laplacian(layout->element_sums, values);
    for (const Actuator& actuator : system.actuators()) {
        if (actuator.gaps() != nullptr) actuator.gaps()->add_laplacian(model.free_index(), scalar, values);
    }
    // The Laplacian is scalar: a node held in some directions is weakly held in all, so that the body is held.
    for (const FreeRoller& roller : system.rollers()) {
        double& diagonal = values[static_cast<std::size_t>(scalar.node_start[static_cast<std::size_t>(roller.free)])];
        diagonal *= 1 + (3 - roller.may_move.trace()) / 3;
    }
    state_ = std::make_unique<State>();
    state_->model = &model;
    state_->layout = std::move(layout);
    state_->followers = order_of_joints<State::Follower>(model.description());
    hold_free_pieces(system, scalar, values);
    state_->invert(scalar, values, most_entries);
}

void FactoredLaplacian::State::invert(const linalg::SymmetricPattern& pattern, const std::vector<double>& values,
                                      double most_entries) {
    const double full = 0.5 * pattern.nodes * pattern.nodes;  // entries of a factor without zeros
    const linalg::FactorSize size = full > most_entries ? linalg::estimate_factor_size(pattern) : linalg::FactorSize{};
    if (size.entries > most_entries) {
        work = size.work;
        const std::optional<linalg::Nesting> corners = nest_in_corners(*model);
        levels.emplace(pattern, values, corners ? &*corners : nullptr);
        return;
    }
    factor.emplace(pattern);
    work = factor->factor_work();
    analysis = factor->analysis();
    // Positive definite by construction: every piece is held, by supports or weakly, and all weights are positive.
    [[maybe_unused]] const bool done = factor->factorise(values);
    factor->release_work_space();
}

/// Pieces without support are weakly held at all nodes, and objects have only this stiffness: the Laplacian then gives
/// the direction of their motion, but not its size.
void FactoredLaplacian::hold_free_pieces(const Equilibrium& system, const linalg::SymmetricPattern& scalar,
                                         std::span<double> values) {
    const Model& model = system.model();
    if (model.free_pieces().empty() && model.objects().empty()) return;
    const auto diagonal = [&](int node) -> double& {
        const int free = model.free_index()[static_cast<std::size_t>(node)];
        return values[static_cast<std::size_t>(scalar.node_start[static_cast<std::size_t>(free)])];
    };
    double sum = 0;
    for (const int node : model.mesh().nodes)
        if (model.free_index()[static_cast<std::size_t>(node)] >= 0) sum += diagonal(node);
    const double mean = sum / static_cast<double>(model.mesh().nodes.size());
    std::vector<double> hold(static_cast<std::size_t>(model.node_count()), 0.0);
    for (const std::vector<int>& piece : model.free_pieces())
        for (const int node : piece) hold[static_cast<std::size_t>(node)] = small_hold * mean;
    for (const AffineBody& object : model.objects())
        for (const int node : object.nodes()) hold[static_cast<std::size_t>(node)] = object.node_stiffness();
    for (std::size_t node = 0; node < hold.size(); ++node) {
        if (hold[node] == 0) continue;
        diagonal(static_cast<int>(node)) += hold[node];
        state_->held.emplace_back(static_cast<int>(node), hold[node]);
    }
}

void FactoredLaplacian::add_hold(const Eigen::VectorXd& motion, Eigen::VectorXd& forces) const {
    for (const auto& [node, hold] : state_->held)
        forces.segment<3>(3 * static_cast<Eigen::Index>(node)) +=
            hold * motion.segment<3>(3 * static_cast<Eigen::Index>(node));
}

FactoredLaplacian::FactoredLaplacian(FactoredLaplacian&&) noexcept = default;
FactoredLaplacian::~FactoredLaplacian() = default;

const std::shared_ptr<const TangentLayout>& FactoredLaplacian::tangent_layout() const {
    return state_->layout;
}

const std::shared_ptr<const linalg::Analysis>& FactoredLaplacian::analysis() const {
    const std::lock_guard lock(state_->analysing);
    if (!state_->analysis) state_->analysis = linalg::analyse(state_->layout->pattern);
    return state_->analysis;
}

double FactoredLaplacian::work() const {
    return state_->work;
}

void FactoredLaplacian::solve(Eigen::Ref<Eigen::MatrixXd> columns) const {
    const std::span<double> fields(columns.data(), static_cast<std::size_t>(columns.size()));
    if (state_->levels)
        state_->levels->solve(fields, static_cast<int>(columns.cols()), levels_tolerance);
    else
        state_->factor->solve_fields(fields, static_cast<int>(columns.cols()));
}

Eigen::VectorXd FactoredLaplacian::follow(const Equilibrium& system, const Eigen::VectorXd& support_motion) const {
    Eigen::VectorXd coupling = Eigen::VectorXd::Zero(support_motion.size());
    state_->model->elements().apply_laplacian(linalg::view(support_motion), linalg::view(coupling));
    Eigen::VectorXd motion = -system.restrict_to_free(coupling);
    if (!system.rollers().empty()) return follow_on_rollers(system, motion);
    solve(motion);
    return motion;
}

/// Conjugate gradients on the Laplacian restricted to free directions, with the factor as preconditioner.
Eigen::VectorXd FactoredLaplacian::follow_on_rollers(const Equilibrium& system, const Eigen::VectorXd& forces) const {
    constexpr int most_rounds = 60;
    constexpr double enough = 1e-3;
    const auto multiply = [&](const Eigen::VectorXd& v) {
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(3 * state_->model->node_count()), force = motion;
        system.add_free(v, 1, motion);
        state_->model->elements().apply_laplacian(linalg::view(motion), linalg::view(force));
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
    state_->model->elements().add_rotation_term(rotating, linalg::view(turned));
    Eigen::VectorXd correction = system.restrict_to_free(turned);
    solve(correction);
    system.add_free(correction, 1, end);
    carry_free_pieces(*state_->model, rotating, end);
    for (const AffineBody& object : state_->model->objects()) turn_object(object, rotating, end);
    if (!state_->followers.empty()) keep_joined(system, rotating, end);
    return end;
}

/// A rotation about its own centre moves an object off its joints, which a straight step preserves: it is shifted back.
void FactoredLaplacian::keep_joined(const Equilibrium& system, const RotatingStep& rotating,
                                    Eigen::VectorXd& end) const {
    Eigen::VectorXd straight(end.size());
    for (int node = 0; node < state_->model->node_count(); ++node)
        straight.segment<3>(3 * Eigen::Index{node}) = straight_end(rotating, node);
    for (const State::Follower& f : state_->followers) {
        const JointForce& joint = system.joints()[f.joint];
        const linalg::Vector3 shift =
            f.sign * (joint.gap(linalg::view(std::as_const(straight))) - joint.gap(linalg::view(std::as_const(end))));
        for (const int node : system.objects()[static_cast<std::size_t>(f.object)].nodes())
            end.segment<3>(3 * Eigen::Index{node}) += shift;
    }
}

std::unique_ptr<Curvature> make_local_global(const FactoredLaplacian& laplacian) {
    return std::make_unique<LocalGlobal>(laplacian);
}

}  // namespace pliant::sim
