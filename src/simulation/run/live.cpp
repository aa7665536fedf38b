#include "simulation/run/live.hpp"

#include <algorithm>
#include <utility>

#include "base/core/stopwatch.hpp"
#include "simulation/run/describe.hpp"
#include "simulation/run/warnings.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant::sim {
namespace {

constexpr double least_stride = 1.0 / 256;
constexpr double largest_stride = 8;
constexpr int quick = 3;             // with fewer iterations the next increment may be larger
constexpr int most_iterations = 40;  // per increment: rather a smaller one than a long wait
constexpr double least_way = 1e-300;

/// Inputs change direction at any time: only the last state is useful for prediction.
StepperOptions options_of(const Program& program) {
    return {program.solver, program.tolerance, most_iterations, std::nullopt, 1, program.duration / program.steps};
}

}  // namespace

class Live::Walk {
public:
    Walk(const Model& model, const Program& program)
        : stepper_(model, options_of(program)), spring_(stepper_.system(), stepper_.laplacian()) {
        return_to_rest();
    }

    void return_to_rest() {
        robot_ = stepper_.rest();
        spring_.let_go();
        last_ = {};
        stride_ = 1;
        stale_ = false;
    }

    [[nodiscard]] LiveTarget target_at(double time) const {
        return {time, stepper_.program(time).drives, std::nullopt};
    }

    [[nodiscard]] Drive hold(std::size_t a, Drive::Kind kind) const { return stepper_.hold(robot_, a, kind); }

    LiveProgress advance(const LiveTarget& target, const Progress& progress) {
        Stopwatch watch;
        take_up(target);
        const Inputs wanted{target.time, target.drives, wanted_force(target.pull)};
        LiveProgress result;
        const double way = distance(wanted);
        if (way > 0) result = go(wanted, way, progress);
        result.arrived = result.reason.empty() && distance(wanted) == 0 && is_settled(target.pull);
        result.wall_s = wall_s_ = watch.read_s();
        return result;
    }

    [[nodiscard]] Step describe() const {
        Step step;
        step.time = robot_.inputs.time;
        step.iterations = last_.iterations;
        step.wall_s = wall_s_;
        step.solver = last_.solver;
        step.converged = !last_.loose;
        if (last_.loose) step.reason = last_.reason;
        const State& state = robot_.now.state;
        sim::describe(stepper_.model(), system(), state, robot_.controls, robot_.evaluation, step);
        step.crossing_m = system().crossing(state, robot_.controls);
        return step;
    }

    [[nodiscard]] std::vector<std::string> gap_warnings() const {
        std::vector<std::string> warnings;
        for (const ClosedGap& gap : closed_gaps(system(), robot_.x()))
            warnings.push_back(closed_gap_text(stepper_.model(), gap));
        return warnings;
    }

    [[nodiscard]] Vec3 pull_force_N() const {
        if (!spring_.pull()) return {};
        return {robot_.inputs.force_N[0], robot_.inputs.force_N[1], robot_.inputs.force_N[2]};
    }

    [[nodiscard]] Stepper& stepper() { return stepper_; }
    [[nodiscard]] const RobotState& state() const { return robot_; }
    void set_state(RobotState state, double wall_s) {
        robot_ = std::move(state);
        spring_.let_go();
        stale_ = false;
        last_ = {};
        wall_s_ = wall_s;
    }

    [[nodiscard]] std::vector<double> rest_measures() const {
        std::vector<double> measures;
        for (std::size_t a = 0; a < steered(); ++a) measures.push_back(system().actuators()[a].rest_measure());
        return measures;
    }

private:
    [[nodiscard]] const Equilibrium& system() const { return stepper_.system(); }
    [[nodiscard]] std::size_t steered() const {
        const Description& d = stepper_.model().description();
        return d.steered_count();
    }

    /// Restarts the path if another point is pulled, or an actuator is driven by another kind.
    void take_up(const LiveTarget& target) {
        if (target.pull && spring_.take_up(*target.pull, robot_)) {
            if (robot_.inputs.force_N.squaredNorm() > 0) stale_ = true;  // it was released at once
            robot_.inputs.force_N.setZero();
            robot_.before.reset();
        }
        for (std::size_t a = 0; a < steered(); ++a) {
            if (robot_.inputs.drives[a].kind == target.drives[a].kind) continue;
            robot_.inputs.drives[a] = hold(a, target.drives[a].kind);
            robot_.before.reset();
        }
    }

    /// Without a pull the force decreases to zero along the path.
    [[nodiscard]] Eigen::Vector3d wanted_force(const std::optional<Pull>& pull) const {
        return pull ? spring_.balance(robot_.x(), robot_.inputs.force_N) : Eigen::Vector3d::Zero();
    }

    [[nodiscard]] bool is_settled(const std::optional<Pull>& pull) const {
        return !pull || spring_.is_settled(robot_.x(), robot_.inputs.force_N);
    }

    /// Distance to `wanted`, in increments at a stride of 1.
    [[nodiscard]] double distance(const Inputs& wanted) const {
        double most = stepper_.units().distance(robot_.inputs, wanted);
        if (stale_) most = std::max(most, least_way);
        const Eigen::Vector3d change = wanted.force_N - robot_.inputs.force_N;
        if (change.squaredNorm() == 0) return most;
        return std::max({most, spring_.pull() ? spring_.distance(change) : change.norm() / stepper_.units().tension_N(),
                         least_way});
    }

    [[nodiscard]] Controls controls_of(const Inputs& inputs) const {
        Controls controls = stepper_.controls(robot_, inputs);
        if (spring_.pull()) spring_.add_force(inputs.force_N, controls.external_N);
        return controls;
    }

    LiveProgress go(const Inputs& wanted, double way, const Progress& progress) {
        LiveProgress result;
        for (;;) {
            const Inputs next = between(robot_.inputs, wanted, std::min(1.0, stride_ / way));
            const StepReport report = leap(next, progress);
            result.iterations += report.iterations;
            if (report.arrived) {
                result.moved = true;
                last_ = report;
                last_.iterations = result.iterations;
                if (result.iterations <= quick) stride_ = std::min(1.6 * stride_, largest_stride);
                return result;
            }
            stride_ = 0.5 * std::min(stride_, way);
            if (progress.cancelled() || stride_ < least_stride) {
                stride_ = std::max(stride_, least_stride);
                result.reason = report.reason;
                return result;
            }
        }
    }

    /// Extrapolates the path of the last increment if this one has the same or the opposite direction; else starts from
    /// the current state.
    StepReport leap(const Inputs& next, const Progress& progress) {
        const bool onward = stepper_.set_course(robot_, next);
        const StepPath path{1, [&](double) { return controls_of(next); }, 0, onward};
        const Inputs now = robot_.inputs;
        const Vec3 point = spring_.pull() ? spring_.point_at(robot_.x()) : Vec3{};
        StepReport report = stepper_.leap(robot_, path, progress);
        if (!report.arrived) return report;
        if (spring_.pull()) learn(now, next, spring_.point_at(robot_.x()) - point);
        robot_.before = now;
        robot_.inputs = next;
        stale_ = false;
        return report;
    }

    void learn(const Inputs& now, const Inputs& next, const Vec3& moved_m) {
        const Eigen::Vector3d force = next.force_N - now.force_N;
        const double pieces = force.norm() / stepper_.units().tension_N();
        if (!(pieces > 1e-9)) return;
        if (stepper_.units().change(now, next).norm() > 1.05 * pieces) return;  // other inputs moved it too
        spring_.learn(force, moved_m);
    }

    Stepper stepper_;
    PullSpring spring_;
    RobotState robot_;
    bool stale_ = false;  ///< the state is not in equilibrium with its inputs
    double stride_ = 1;
    StepReport last_;  ///< of the increment that led to the state
    double wall_s_ = 0;
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
    for (std::string& gap : walk_->gap_warnings()) warnings.push_back(std::move(gap));
    return warnings;
}
Vec3 Live::pull_force_N() const {
    return walk_->pull_force_N();
}
Stepper& Live::stepper() {
    return walk_->stepper();
}
const RobotState& Live::state() const {
    return walk_->state();
}
void Live::set_state(RobotState state, double wall_s) {
    walk_->set_state(std::move(state), wall_s);
}
std::vector<double> Live::rest_measures() const {
    return walk_->rest_measures();
}

}  // namespace pliant::sim
