// One piece of a step: where it starts, its formula in time, and what is kept of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulation/elements/elements.hpp"
#include "simulation/solver/friction_rounds.hpp"
#include "simulation/stepper/prediction.hpp"
#include "simulation/stepper/step_piece.hpp"
#include "simulation/stepper/taut_cables.hpp"

namespace pliant::sim {
namespace {

constexpr int friction_rounds = 30;
constexpr int steps_of_impact = 3;  // with a formula that takes away the velocity from before it

/// Positions a step ago; at the start of a motion those of now.
const Eigen::VectorXd& a_step_ago(const History& history) {
    return history.dt_before > 0 ? history.x_before : history.x;
}

}  // namespace

void note(const std::vector<IterationRecord>& history, double along, StepReport& report) {
    for (IterationRecord record : history) {
        record.time = along;
        report.history.push_back(record);
    }
}

/// Solves one piece; if the robot meets itself on the way, it is solved again with contact.
StepOutcome Stepper::go(RobotState& robot, const Target& target, StepReport& report, const Progress& progress) {
    StepOutcome outcome;
    int iterations = 0;
    for (;;) {
        Controls controls = target.controls;
        controls.met = robot.controls.met;
        State next;
        int touching = 0;
        outcome = chooses_scheme() ? attempt_in_time(robot, target, controls, next, touching, progress)
                                   : attempt(robot, target, Scheme::even, controls, next, progress);
        iterations += outcome.iterations;
        note(outcome.history, target.along, report);
        if (outcome.converged && system_.meets_itself(robot.now.state, robot.controls, next, controls)) {
            robot.controls.met = true;
            continue;
        }
        outcome.iterations = iterations;
        report.iterations += iterations;
        if (!outcome.converged) return outcome;
        report.solver = outcome.solver;
        ++report.pieces;
        if (outcome.loose) {
            report.loose = true;
            report.reason = outcome.reason;
        }
        accept(robot, target, std::move(controls), std::move(next), touching, outcome);
        return outcome;
    }
}

/// True if the formula of a step depends on what happens in it.
bool Stepper::chooses_scheme() const {
    if (!options_.dynamics) return false;
    const auto has_stop = [](const Joint& joint) {
        return std::isfinite(joint.law.low) || std::isfinite(joint.law.high);
    };
    return is_adaptive() || options_.dynamics->integrator != Integrator::bdf2 || model_.contact(true) != nullptr ||
           std::ranges::any_of(system_.actuators(), &Actuator::only_pulls) ||
           std::ranges::any_of(model_.description().joints, has_stop);
}

/// 0: nothing touches; else the number of this step among those since something new did.
int Stepper::touching_after(const RobotState& robot, const State& next, const Controls& controls) const {
    const Touching there = system_.touching(next, controls);
    const std::vector<int> holding = holding_cables(system_, next, controls);
    const bool as_before = (there.none() || there.is_part_of(system_.touching(robot.now.state, robot.controls))) &&
                           std::ranges::includes(taut_cables(system_, robot.now.state, robot.controls), holding);
    if (!as_before) return 1;
    const int so_far = robot.history.touching;
    if (!there.none()) return std::max(so_far, 1) + 1;
    const bool is_caught = !holding.empty() && 0 < so_far && so_far < steps_of_impact;
    return is_caught ? so_far + 1 : 0;
}

/// Things that touch use formulas that dissipate unresolved motion, as in an impact. The step in which that begins, and
/// the two after it, do not use earlier states: the first may end just where the surfaces meet, so that only the second
/// takes the velocity away, and BDF2 looks back two steps.
Scheme Stepper::scheme(const RobotState& robot, const Controls& controls) const {
    if (robot.history.touching > 0 && robot.history.touching < steps_of_impact) return Scheme::euler;
    if (!is_adaptive() && options_.dynamics->integrator == Integrator::bdf2) return Scheme::even;
    if (robot.history.touching > 0 || options_.dynamics->integrator == Integrator::bdf2) return Scheme::bdf2;
    // A prescribed length, volume or angle refers to the end of the step, not to the mean; a damped joint, to its loss
    // by then.
    const bool prescribed =
        std::ranges::any_of(controls.drives, [](const Drive& drive) { return drive.kind == Drive::Kind::measure; });
    const bool by_joint = std::ranges::any_of(model_.description().joints, [](const Joint& joint) {
        return joint.law.damping > 0 || joint.law.drive != JointLaw::Drive::none;
    });
    return prescribed || by_joint ? Scheme::bdf2 : Scheme::conserving;
}

/// Loads, torques, tensions and pressures of a conserving step are the means of their values at both ends.
void Stepper::take_mean_inputs(const RobotState& robot, Controls& controls) const {
    const Controls begin = system_.controls(robot.controls.time), end = system_.controls(controls.time);
    controls.external_N += 0.5 * (begin.external_N - end.external_N);
    for (std::size_t k = 0; k < controls.torque_Nm.size(); ++k)
        controls.torque_Nm[k] += 0.5 * (begin.torque_Nm[k] - end.torque_Nm[k]);
    for (std::size_t a = 0; a < controls.drives.size(); ++a) {
        if (controls.drives[a].kind == robot.drives[a].kind)
            controls.drives[a].value = 0.5 * (controls.drives[a].value + robot.drives[a].value);
    }
}

/// Error in time: mean over all masses.
double Stepper::time_error_m(const Controls& controls, const State& next) const {
    const Eigen::VectorXd off = controls.inertia->error(next.x);
    double mass = 0;
    for (const double m : model_.elements().node_mass_kg()) mass += m;
    return mass > 0 ? std::sqrt(std::max(0.0, off.dot(controls.inertia->mass_times(off))) / mass) : 0;
}

/// If things that were apart touch at the end of a step, or it does not converge because of that, it is repeated with a
/// scheme that may dissipate energy: BDF2 would carry the velocity from before the impact into the next steps, and
/// throw bodies higher than they fell.
StepOutcome Stepper::attempt_in_time(const RobotState& robot, const Target& target, Controls& controls, State& next,
                                     int& touching, const Progress& progress) {
    const Controls wanted = controls;
    const Scheme first = scheme(robot, controls);
    if (first == Scheme::conserving) take_mean_inputs(robot, controls);
    StepOutcome outcome = attempt(robot, target, first, controls, next, progress);
    const bool stuck = !outcome.converged && first == Scheme::conserving && !progress.cancelled();
    if (outcome.converged) touching = touching_after(robot, next, controls);
    const bool impact = outcome.converged && first != Scheme::euler && touching == 1;
    if (stuck || impact) {
        Controls again = wanted;
        State there;
        StepOutcome lossy = attempt(robot, target, Scheme::euler, again, there, progress);
        outcome.iterations += lossy.iterations;
        outcome.history.insert(outcome.history.end(), lossy.history.begin(), lossy.history.end());
        const int touching_there = lossy.converged ? touching_after(robot, there, again) : 0;
        if (impact || touching_there > 0) {
            lossy.iterations = outcome.iterations;
            lossy.history = std::move(outcome.history);
            outcome = std::move(lossy);
            controls = std::move(again);
            next = std::move(there);
            touching = touching_there;
        }
    }
    if (!outcome.converged) return outcome;
    if (controls.inertia->scheme() == Scheme::conserving) {  // its forces are those along the path, not at the end
        Controls still = controls;
        still.inertia = nullptr;
        const Evaluation end = system_.evaluate(next, still);
        if (!end.possible()) {
            outcome.converged = false;
            outcome.reason = fmt::format("the end of a step {}", name(end.flaw));
        }
    }
    if (target.error_m == nullptr || !outcome.converged) return outcome;
    *target.error_m = time_error_m(controls, next);
    if (*target.error_m > target.largest_error_m) {
        outcome.converged = false;
        outcome.reason = fmt::format("a step of {:.3g} s is off by {:.3g} mm, more than time_tolerance",
                                     controls.inertia->dt(), 1e3 * *target.error_m);
    }
    return outcome;
}

StepOutcome Stepper::attempt(const RobotState& robot, const Target& target, Scheme scheme, Controls& controls,
                             State& next, const Progress& progress) {
    if (options_.dynamics) controls.inertia = motion_->inertia(robot.history, target.along - robot.now.along, scheme);
    if (tether_dt_s_ > 0) controls.inertia = motion_->inertia(MotionInTime::still(robot.x()), tether_dt_s_);
    controls.object_stress.clear();
    if (controls.of_means()) controls.object_stress = system_.object_stress(a_step_ago(robot.history), robot.x());
    controls.joint_start = system_.joint_coordinates(robot.x(), robot.controls);
    const std::optional<double> along = target.onward ? std::optional(target.along) : std::nullopt;
    std::optional<Prediction> expected;
    if (target.expected != nullptr) expected = start_from(system_, robot, *target.expected, controls);
    Prediction start = expected ? *std::move(expected) : predict(system_, laplacian_, robot, controls, along, progress);
    // What was pushed and is not held would go on as it moved before, since the tether is too weak to be noticed.
    constexpr double noticeable = 1e-4;  // share of the largest coordinate
    const auto goes_on = [&] {
        return start.reason.empty() && start.evaluation.error() <= options_.tolerance &&
               (start.state.x - robot.x()).lpNorm<Eigen::Infinity>() > noticeable * robot.x().lpNorm<Eigen::Infinity>();
    };
    if (tether_dt_s_ > 0 && along && !expected && model_.contact(controls.met) != nullptr && goes_on())
        start = predict(system_, laplacian_, robot, controls, {}, progress);
    if (!start.reason.empty()) {
        StepOutcome outcome;
        outcome.no_start = true;
        outcome.reason = std::move(start.reason);
        return outcome;
    }
    next = std::move(start.state);
    solvers_.restart();
    const int limit = target.iteration_limit > 0 ? target.iteration_limit : options_.iteration_limit;
    StepOutcome outcome = settle(robot, controls, next, progress, std::move(start.evaluation), limit);
    if (tether_dt_s_ > 0 && outcome.converged && model_.contact(controls.met) != nullptr && !system_.has_friction())
        settle_tether(controls, next, progress, outcome);
    return outcome;
}

/// What is pushed and not held comes to rest anywhere ahead of what pushes it: the tolerance of a step does not notice
/// the tether, which holds it back. Here it counts; what it then holds on to is the nearest place.
void Stepper::settle_tether(const Controls& controls, State& next, const Progress& progress, StepOutcome& outcome) {
    constexpr double share = 1e-3;  // of the tolerance
    constexpr int most = 30;
    State settled = next;
    StepOutcome fine =
        solvers_.solve(system_, controls, {share * options_.tolerance, most}, settled, progress, outcome.evaluation);
    if (!fine.converged) return;
    next = std::move(settled);
    outcome.iterations += fine.iterations;
    outcome.evaluation = std::move(fine.evaluation);
    outcome.history.insert(outcome.history.end(), fine.history.begin(), fine.history.end());
}

/// `known`: evaluation of `next`, used if there is no friction.
StepOutcome Stepper::settle(const RobotState& from, Controls& controls, State& next, const Progress& progress,
                            std::optional<Evaluation> known, int iteration_limit) {
    return settle_friction(system_, solvers_, {options_.tolerance, iteration_limit}, friction_rounds,
                           {from.now.state, from.controls, from.drives}, controls, next, progress, std::move(known));
}

void Stepper::accept(RobotState& robot, const Target& target, Controls controls, State next, int touching,
                     StepOutcome outcome) {
    if (options_.dynamics) {
        robot.history = MotionInTime::after(*controls.inertia, next.x);
        robot.history.touching = touching;
    }
    robot.past.push_back({robot.now.along, std::make_shared<const State>(std::move(robot.now.state))});
    if (robot.past.size() > options_.most_past) robot.past.pop_front();
    robot.now = {target.along, std::move(next)};
    robot.drives = target.controls.drives;
    robot.inputs = {controls.time,
                    {robot.drives.begin(), robot.drives.begin() + static_cast<std::ptrdiff_t>(steered())}};
    robot.before.reset();
    robot.controls = std::move(controls);
    robot.evaluation = std::move(outcome.evaluation);
}

}  // namespace pliant::sim
