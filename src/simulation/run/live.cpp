#include "simulation/run/live.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/run/describe.hpp"
#include "simulation/run/warnings.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/solver/friction_rounds.hpp"
#include "simulation/solver/solver_chain.hpp"

namespace pliant::sim {
namespace {

constexpr double least_stride = 1.0 / 256;
constexpr double largest_stride = 8;
constexpr int quick = 3;             // iterations after which the next piece may be larger
constexpr int most_iterations = 40;  // of one piece: rather a smaller one than a long wait
constexpr int friction_rounds = 12;
constexpr double worst_start = 0.2;  // error of a predicted state that is still worth starting from

// What a piece changes at a stride of 1.
constexpr double cable_share = 0.04, chamber_share = 0.1;  // of the measure at rest
constexpr double strain_share = 0.01;                      // of the softest stiffness, for tensions and pressures
constexpr double pull_share = 0.05;                        // of the robot's size, for the point that is pulled

// The spring is so much stiffer than the body that the point follows the handle most of the way.
constexpr double spring_stiffness = 8;
constexpr double pull_tolerance = 2e-3;  // of the robot's size: how near to its balance the spring must be

std::span<const double> view(const Eigen::VectorXd& v) {
    return {v.data(), static_cast<std::size_t>(v.size())};
}
/// All inputs of the robot, as numbers between which one can interpolate.
struct Inputs {
    double time = 0;
    std::vector<Drive> drives;
    Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
};

/// Largest stiffness of the softest material; meshed space that actuators drive is none.
double softest_body_Pa(const Description& d) {
    double softest = std::numeric_limits<double>::infinity();
    for (std::size_t m = 0; m < d.materials.size(); ++m) {
        const auto is_space = [&](const Growth& growth) { return growth.material == static_cast<int>(m); };
        if (std::none_of(d.growths.begin(), d.growths.end(), is_space))
            softest = std::min(softest, material::stiffness_bound(d.materials[m].law));
    }
    return softest;
}

bool same_point(const Attachment& a, const Attachment& b) {
    return a.nodes == b.nodes && a.weights == b.weights;
}

}  // namespace

class Live::Walk {
public:
    Walk(const Model& model, const Program& program)
        : model_(model),
          program_(program),
          system_(model),
          laplacian_(system_),
          chain_(make_chain(program.solver, system_, laplacian_)) {
        const double softest = softest_body_Pa(model.description());
        const double length = std::cbrt(mesh::volume(model.mesh()));
        tension_unit_ = strain_share * softest * length * length;
        pressure_unit_ = strain_share * softest;
        Vec3 low = model.mesh().points.front(), high = low;
        for (const Vec3& p : model.mesh().points) {
            low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
        }
        size_m_ = norm(high - low);
        return_to_rest();
    }

    void return_to_rest() {
        state_ = system_.rest();
        system_.set_met(false);
        inputs_ = {0, target_at(0).drives, Eigen::Vector3d::Zero()};
        controls_ = system_.controls(0);
        evaluation_ = system_.evaluate(state_, controls_);
        before_.reset();
        pulled_.reset();
        loose_.clear();
        stride_ = 1;
        stale_ = false;
        iterations_ = 0;
    }

    [[nodiscard]] LiveTarget target_at(double time) const {
        const Controls controls = system_.controls(time);
        LiveTarget target{time, {}, std::nullopt};
        for (std::size_t a = 0; a < steered(); ++a) target.drives.push_back(controls.drives[a]);
        return target;
    }

    [[nodiscard]] Drive hold(std::size_t a, Drive::Kind kind) const {
        const double g = system_.actuators()[a].measure(view(state_.x));
        const double m = state_.multiplier[static_cast<Eigen::Index>(a)];
        if (kind == Drive::Kind::measure) return {kind, g};
        if (kind == Drive::Kind::multiplier) return {kind, m};
        return {kind, (model_.description().ambient_pressure_Pa - m) * g};
    }

    LiveProgress advance(const LiveTarget& target, const Progress& progress) {
        const auto start = std::chrono::steady_clock::now();
        take_up(target.pull);
        for (std::size_t a = 0; a < steered(); ++a) {
            if (inputs_.drives[a].kind == target.drives[a].kind) continue;
            inputs_.drives[a] = hold(a, target.drives[a].kind);
            before_.reset();
        }
        const Inputs wanted{target.time, target.drives, wanted_force(target.pull)};
        LiveProgress result;
        const double way = distance(wanted);
        if (way > 0) result = go(wanted, way, progress);
        result.arrived = result.reason.empty() && distance(wanted) == 0 && spring_settled(target.pull);
        result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        wall_s_ = result.wall_s;
        return result;
    }

    [[nodiscard]] Step describe() const {
        Step step;
        step.time = inputs_.time;
        step.iterations = iterations_;
        step.wall_s = wall_s_;
        step.solver = solver_;
        step.converged = loose_.empty();
        step.reason = loose_;
        sim::describe(model_, system_, state_, controls_, evaluation_, step);
        step.crossing_m = system_.crossing(state_, controls_);
        return step;
    }

    [[nodiscard]] std::vector<std::string> closed_gaps() const {
        std::vector<std::string> warnings;
        if (const auto* contact = model_.contact(true); contact != nullptr && contact->settings().self) return warnings;
        for (std::size_t c = 0; c < system_.cable_count(); ++c) {
            const int segment = system_.actuators()[c].cable().closed_segment(view(state_.x));
            if (segment >= 0) warnings.push_back(closed_gap_text(model_.description().cables[c].name, segment));
        }
        return warnings;
    }

    [[nodiscard]] Vec3 pull_force_N() const {
        if (!pulled_) return {};
        return {inputs_.force_N[0], inputs_.force_N[1], inputs_.force_N[2]};
    }

    [[nodiscard]] std::vector<double> rest_measures() const {
        std::vector<double> measures;
        for (std::size_t a = 0; a < steered(); ++a) measures.push_back(system_.actuators()[a].rest_measure());
        return measures;
    }

private:
    [[nodiscard]] std::size_t steered() const {
        return model_.description().cables.size() + model_.description().chambers.size();
    }

    /// How far `wanted` is, in pieces at a stride of 1.
    [[nodiscard]] double distance(const Inputs& wanted) const {
        double most = std::fabs(wanted.time - inputs_.time) * program_.steps / program_.duration;
        if (stale_) most = std::max(most, 1e-300);
        for (std::size_t a = 0; a < steered(); ++a) {
            const double change = std::fabs(wanted.drives[a].value - inputs_.drives[a].value);
            most = std::max(most, change / unit(a, wanted.drives[a].kind));
        }
        const Eigen::Vector3d change = wanted.force_N - inputs_.force_N;
        if (change.squaredNorm() > 0 && pulled_)
            most = std::max({most, (compliance_ * change).norm() / (pull_share * size_m_), 1e-300});
        else if (change.squaredNorm() > 0)
            most = std::max(most, change.norm() / tension_unit_);
        return most;
    }

    [[nodiscard]] double unit(std::size_t a, Drive::Kind kind) const {
        const bool cable = a < system_.cable_count();
        const double rest = system_.actuators()[a].rest_measure();
        switch (kind) {
            case Drive::Kind::measure:
                return (cable ? cable_share : chamber_share) * rest;
            case Drive::Kind::multiplier:
                return cable ? tension_unit_ : pressure_unit_;
            case Drive::Kind::gas:
                return chamber_share * model_.description().ambient_pressure_Pa * rest;
        }
        return 1;
    }

    [[nodiscard]] static Inputs between(const Inputs& from, const Inputs& to, double share) {
        if (share >= 1) return to;
        Inputs inputs = to;
        inputs.time = from.time + share * (to.time - from.time);
        for (std::size_t a = 0; a < to.drives.size(); ++a)
            inputs.drives[a].value = from.drives[a].value + share * (to.drives[a].value - from.drives[a].value);
        inputs.force_N = from.force_N + share * (to.force_N - from.force_N);
        return inputs;
    }

    [[nodiscard]] Controls controls_of(const Inputs& inputs) const {
        Controls controls = system_.controls(inputs.time);
        for (std::size_t a = 0; a < steered(); ++a) controls.drives[a] = inputs.drives[a];
        if (pulled_) {
            for (std::size_t k = 0; k < pulled_->point.nodes.size(); ++k)
                controls.external_N.segment<3>(3 * pulled_->point.nodes[k]) +=
                    pulled_->point.weights[k] * inputs.force_N;
        }
        return controls;
    }

    LiveProgress go(const Inputs& wanted, double way, const Progress& progress) {
        LiveProgress result;
        for (;;) {
            const Inputs next = between(inputs_, wanted, std::min(1.0, stride_ / way));
            Controls controls = controls_of(next);
            State state;
            std::optional<Evaluation> known;
            std::string reason = predict(next, controls, state, known);
            StepOutcome outcome;
            if (reason.empty()) {
                outcome = solve(controls, state, progress, std::move(known));
                result.iterations += outcome.iterations;
                reason = outcome.converged ? "" : outcome.reason;
            }
            if (reason.empty() && system_.meets_itself(state_, controls_, state, controls)) {
                system_.set_met(true);
                controls_.met = true;
                continue;
            }
            if (reason.empty()) {
                accept(next, std::move(controls), std::move(state), std::move(outcome));
                result.moved = true;
                iterations_ = result.iterations;
                if (result.iterations <= quick) stride_ = std::min(1.6 * stride_, largest_stride);
                return result;
            }
            stride_ = 0.5 * std::min(stride_, way);
            if (progress.cancelled() || stride_ < least_stride) {
                stride_ = std::max(stride_, least_stride);
                result.reason = reason;
                return result;
            }
        }
    }

    void accept(const Inputs& next, Controls controls, State state, StepOutcome outcome) {
        learn_compliance(next, state);
        before_ = Known{inputs_, std::move(state_)};
        stale_ = false;
        state_ = std::move(state);
        inputs_ = next;
        controls_ = std::move(controls);
        evaluation_ = std::move(outcome.evaluation);
        solver_ = outcome.solver;
        loose_ = outcome.loose ? outcome.reason : std::string();
    }

    /// On along the way of the last piece where this one goes the same way, or back; else from where it is.
    /// `known` is the evaluation of that state, if it was needed.
    [[nodiscard]] std::string predict(const Inputs& next, const Controls& controls, State& state,
                                      std::optional<Evaluation>& known) const {
        if (before_) {
            const double onward = onward_share(next);
            if (onward != 0 && (known = extrapolate(onward, controls, state))) return {};
        }
        state = state_;
        system_.place_supports(controls, state.x);
        const Eigen::VectorXd motion = state.x - state_.x;
        if (motion.squaredNorm() > 0) system_.add_free(laplacian_.follow(system_, motion), 1, state.x);
        if (!(model_.elements().evaluate(view(state.x), {}).min_J > 0))
            return "the prescribed motion turns a tetrahedron inside out";
        return passes(state, controls) ? "" : "the prescribed motion passes through something in one go";
    }

    /// Its evaluation, if it will do.
    [[nodiscard]] std::optional<Evaluation> extrapolate(double onward, const Controls& controls, State& state) const {
        const State& before = before_->state;
        state = {state_.x, state_.multiplier + onward * (state_.multiplier - before.multiplier)};
        system_.place_supports(controls, state.x);
        const RotatingStep rotating{state_.x.data(), state.x.data(), {before.x.data()}, {onward}};
        state.x = laplacian_.rotate(system_, rotating);
        for (std::size_t c = 0; c < system_.cable_count(); ++c) {
            double& tension = state.multiplier[static_cast<Eigen::Index>(c)];
            if (system_.actuators()[c].only_pulls()) tension = std::max(tension, 0.0);
        }
        Evaluation there = system_.evaluate(state, controls);
        if (!(there.min_J > 0) || !(there.error() < worst_start) || !passes(state, controls)) return std::nullopt;
        return there;
    }

    [[nodiscard]] bool passes(const State& next, const Controls& controls) const {
        return system_.largest_step(state_.x, next.x - state_.x, controls_, controls.obstacles - controls_.obstacles) >=
               1;
    }

    /// The coming change as a multiple of the last one; 0 where they are not nearly parallel.
    [[nodiscard]] double onward_share(const Inputs& next) const {
        const Eigen::VectorXd last = change(before_->inputs, inputs_), coming = change(inputs_, next);
        const double length = last.squaredNorm();
        if (!(length > 0) || !(coming.squaredNorm() > 0)) return 0;
        const double share = last.dot(coming) / length;
        const double aside = (coming - share * last).norm();
        constexpr double straight = 0.3, farthest = 4;
        return aside <= straight * coming.norm() && std::fabs(share) <= farthest ? share : 0;
    }

    [[nodiscard]] Eigen::VectorXd change(const Inputs& from, const Inputs& to) const {
        Eigen::VectorXd d(4 + static_cast<Eigen::Index>(steered()));
        d[0] = (to.time - from.time) * program_.steps / program_.duration;
        d.segment<3>(1) = (to.force_N - from.force_N) / tension_unit_;
        for (std::size_t a = 0; a < steered(); ++a)
            d[4 + static_cast<Eigen::Index>(a)] =
                (to.drives[a].value - from.drives[a].value) / unit(a, to.drives[a].kind);
        return d;
    }

    /// `known`: of `state`, as long as there is no friction.
    StepOutcome solve(Controls& controls, State& state, const Progress& progress, std::optional<Evaluation> known) {
        chain_.restart();
        return settle_friction(system_, chain_, {program_.tolerance, most_iterations}, friction_rounds,
                               {state_, controls_, inputs_.drives}, controls, state, progress, std::move(known));
    }

    /// A new point that is pulled: how the body gives way there tells how stiff the spring is.
    void take_up(const std::optional<Pull>& pull) {
        if (pull && pulled_ && same_point(pull->point, pulled_->point)) {
            pulled_->handle_m = pull->handle_m;
            return;
        }
        if (!pull) return;                                     // the force falls to zero on the way
        if (inputs_.force_N.squaredNorm() > 0) stale_ = true;  // it was let go of in one go
        inputs_.force_N.setZero();
        pulled_ = pull;
        before_.reset();
        compliance_ = compliance_at(pull->point);
        spring_N_m_ = 3 * spring_stiffness / std::max(compliance_.trace(), 1e-300);
    }

    /// Motion of a point for a unit force on it, from the tangent at hand; m/N.
    [[nodiscard]] Eigen::Matrix3d compliance_at(const Attachment& point) const {
        Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(3 * model_.free_count(), 3);
        for (std::size_t k = 0; k < point.nodes.size(); ++k) {
            const int free = model_.free_index()[static_cast<std::size_t>(point.nodes[k])];
            if (free >= 0) columns.middleRows<3>(3 * free) += point.weights[k] * Eigen::Matrix3d::Identity();
        }
        const Eigen::MatrixXd forces = columns;
        const auto tangent = make_newton(system_, laplacian_);
        if (tangent->refresh(state_, controls_, TangentChoice::projected, {}))
            tangent->solve(columns);
        else
            laplacian_.solve(columns);
        const Eigen::Matrix3d compliance = forces.transpose() * columns;
        return 0.5 * (compliance + compliance.transpose());
    }

    /// Broyden's rank-one correction: what the last change of force has moved.
    void learn_compliance(const Inputs& next, const State& state) {
        if (!pulled_) return;
        const Eigen::Vector3d force = next.force_N - inputs_.force_N;
        if (!(force.norm() > 1e-9 * tension_unit_)) return;
        if (change(inputs_, next).norm() > 1.05 * force.norm() / tension_unit_) return;  // others moved it too
        const Eigen::Vector3d moved =
            linalg::vector(position(pulled_->point, view(state.x)) - position(pulled_->point, view(state_.x)));
        const Eigen::Matrix3d better =
            compliance_ + (moved - compliance_ * force) * force.transpose() / force.squaredNorm();
        const Eigen::Matrix3d even = 0.5 * (better + better.transpose());
        if (Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(even).eigenvalues()[0] >= 0) compliance_ = even;
    }

    [[nodiscard]] Eigen::Vector3d spring_gap(const Pull& pull) const {
        const Vec3 stretch = pull.handle_m - position(pull.point, view(state_.x));
        return spring_N_m_ * linalg::vector(stretch) - inputs_.force_N;
    }

    [[nodiscard]] bool spring_settled(const std::optional<Pull>& pull) const {
        return !pull || spring_gap(*pull).norm() <= pull_tolerance * size_m_ * spring_N_m_;
    }

    /// The force at which the spring and the body are in balance, as far as the compliance tells.
    [[nodiscard]] Eigen::Vector3d wanted_force(const std::optional<Pull>& pull) const {
        if (!pull) return Eigen::Vector3d::Zero();
        if (spring_settled(pull)) return inputs_.force_N;
        const Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity() + spring_N_m_ * compliance_;
        return inputs_.force_N + matrix.inverse() * spring_gap(*pull);
    }

    struct Known {
        Inputs inputs;
        State state;
    };

    const Model& model_;
    Program program_;
    Equilibrium system_;
    FactoredLaplacian laplacian_;
    SolverChain chain_;
    double tension_unit_ = 1, pressure_unit_ = 1, size_m_ = 1;
    State state_;
    Inputs inputs_;      ///< of the state
    Controls controls_;  ///< of the state
    Evaluation evaluation_;
    std::optional<Known> before_;  ///< the state before, if the way from it is worth following
    std::optional<Pull> pulled_;
    Eigen::Matrix3d compliance_ = Eigen::Matrix3d::Zero();
    double spring_N_m_ = 0;
    bool stale_ = false;  ///< the state is not in equilibrium with its inputs
    double stride_ = 1;
    std::string loose_;  ///< on which looser terms the state was accepted; empty: it converged
    int iterations_ = 0;
    double wall_s_ = 0;
    Solver solver_ = Solver::automatic;
};

Live::Live(const Model& model, const Program& program) : walk_(std::make_unique<Walk>(model, program)) {}
Live::~Live() = default;
Live::Live(Live&&) noexcept = default;
Live& Live::operator=(Live&&) noexcept = default;

LiveTarget Live::target_at(double time) const {
    return walk_->target_at(time);
}
Drive Live::hold(std::size_t a, Drive::Kind kind) const {
    return walk_->hold(a, kind);
}
LiveProgress Live::advance(const LiveTarget& target, const Progress& progress) {
    return walk_->advance(target, progress);
}
void Live::return_to_rest() {
    walk_->return_to_rest();
}
Step Live::describe() const {
    return walk_->describe();
}
std::vector<std::string> Live::warnings(const Step& described) const {
    std::vector<std::string> warnings = warnings_of(described);
    for (std::string& gap : walk_->closed_gaps()) warnings.push_back(std::move(gap));
    return warnings;
}
Vec3 Live::pull_force_N() const {
    return walk_->pull_force_N();
}
std::vector<double> Live::rest_measures() const {
    return walk_->rest_measures();
}

}  // namespace pliant::sim
