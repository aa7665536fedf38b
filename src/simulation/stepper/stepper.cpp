#include "simulation/stepper/stepper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "base/core/boxes.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/solver/friction_rounds.hpp"
#include "simulation/stepper/prediction.hpp"

namespace pliant::sim {
namespace {

constexpr double rounding = 1e-7;            // of the shortest piece
constexpr double smallest_share = 1.0 / 64;  // of a step by inputs
constexpr int friction_rounds = 30;
constexpr int most_in_vain = 3000;  // iterations: as many as quasi-newton may take for one attempt

/// Positions a step ago; at the start of a motion those of now.
const Eigen::VectorXd& a_step_ago(const History& history) {
    return history.dt_before > 0 ? history.x_before : history.x;
}

void note(const std::vector<IterationRecord>& history, double along, StepReport& report) {
    for (IterationRecord record : history) {
        record.time = along;
        report.history.push_back(record);
    }
}

struct FailedAttempt {
    std::string reason;
    bool no_start = false;
};

/// `last`: the last attempt that failed.
void conclude(double along, double end, const FailedAttempt& last, StepReport& report) {
    report.arrived = !(along < end);
    if (report.arrived) return;
    report.reason = last.reason;
    report.no_start = last.no_start;
}

/// Laws without an energy guarantee no descent, however short the step is: if as many iterations as one attempt may
/// take were in vain, further ones are too.
bool is_hopeless(const Model& model, const StepperOptions& options, int in_vain) {
    return !model.elements().has_energy() && in_vain >= std::max(most_in_vain, options.iteration_limit);
}

/// Time step for which a force of a thousandth of the weight moves the resting robot by its own size.
double tether_dt_s(const Model& model) {
    constexpr double share = 1e-3, g_m_s2 = 9.81;
    return std::sqrt(bounds_of(model.mesh().points).diagonal() / (share * g_m_s2));
}

/// Measures the past states along a new path on which the last of them is at `last` and the present one at 0. States
/// that do not lie one behind the other, as after a reversal, cannot be extrapolated together: the older are dropped.
void measure_past(RobotState& robot, double last) {
    constexpr double least_distance = 1e-6;
    const double begin = robot.now.along, length = robot.past.back().along - begin;
    std::deque<PastMoment> kept;
    while (!robot.past.empty()) {
        PastMoment moment = std::move(robot.past.back());
        robot.past.pop_back();
        if (kept.empty()) {
            moment.along = last;
        } else {
            moment.along = last / length * (moment.along - begin);
            if (!(last < 0 && moment.along < kept.front().along + least_distance * last)) break;
        }
        kept.push_front(std::move(moment));
    }
    robot.past = std::move(kept);
}

}  // namespace

/// One piece of a path.
struct Stepper::Target {
    double along;
    Controls controls;
    bool onward;
    const State* expected;      ///< there; null: unknown
    double* error_m = nullptr;  ///< receives the error in time if requested; the step is rejected if it is above the
                                ///< next
    double largest_error_m = 0;
    int iteration_limit = 0;  ///< 0: that of the options
};

Stepper::Stepper(const Model& model, const StepperOptions& options)
    : model_(model),
      options_(options),
      system_(model),
      laplacian_(system_),
      solvers_(make_chain(options.solver, system_, laplacian_, options.dynamics.has_value())),
      units_(system_, options.time_unit) {
    if (options.dynamics)
        motion_.emplace(model, options.dynamics->damping);
    else if (!model.free_pieces().empty() || !model.objects().empty()) {
        motion_.emplace(model, Damping{});
        tether_dt_s_ = tether_dt_s(model);
    }
}

Stepper::~Stepper() = default;

RobotState Stepper::rest() const {
    RobotState robot;
    robot.now = {0, system_.rest()};
    robot.controls = system_.controls(0);
    robot.drives = robot.controls.drives;
    robot.inputs = program(0);
    robot.evaluation = system_.evaluate(robot.now.state, robot.controls);
    if (options_.dynamics) robot.history = motion_->at_rest(robot.x());
    return robot;
}

Controls Stepper::controls(const RobotState& robot, double time) const {
    Controls controls = system_.controls(time);
    controls.met = robot.controls.met;
    controls.joint_start = system_.joint_coordinates(robot.x(), robot.controls);
    return controls;
}

Inputs Stepper::program(double time) const {
    std::vector<Drive> drives = system_.controls(time).drives;
    drives.resize(steered());
    return {time, std::move(drives)};
}

/// Number of cables and chambers; pressure loads follow the program.
std::size_t Stepper::steered() const {
    return model_.description().steered_count();
}

Controls Stepper::controls(const RobotState& robot, const Inputs& inputs) const {
    Controls wanted = controls(robot, inputs.time);
    std::copy(inputs.drives.begin(), inputs.drives.end(), wanted.drives.begin());
    return wanted;
}

Drive Stepper::hold(const RobotState& robot, std::size_t a, Drive::Kind kind) const {
    const double g = system_.actuators()[a].measure({robot.x().data(), static_cast<std::size_t>(robot.x().size())});
    const double m = robot.now.state.multiplier[static_cast<Eigen::Index>(a)];
    if (kind == Drive::Kind::measure) return {kind, g};
    if (kind == Drive::Kind::multiplier) return {kind, m};
    return {kind, (model_.description().ambient_pressure_Pa - m) * g};
}

bool Stepper::set_course(RobotState& robot, const Inputs& wanted) const {
    const double onward = robot.before ? units_.onward_share(*robot.before, robot.inputs, wanted) : 0;
    const bool known = onward != 0 && !robot.past.empty();
    if (known)
        measure_past(robot, -1 / onward);
    else
        robot.past.clear();
    robot.now.along = 0;
    return known;
}

bool Stepper::is_same_time(double a, double b) const {
    constexpr double share = 1e-9;  // of a time step
    constexpr double last_bits = 8 * std::numeric_limits<double>::epsilon();
    return std::fabs(b - a) <= std::max(share * options_.time_unit, last_bits * std::max(std::fabs(a), std::fabs(b)));
}

/// No time passes: there is nothing to do, or the drives would have to jump.
StepReport Stepper::stay(const RobotState& robot, Inputs wanted) const {
    constexpr double no_change = 1e-8;  // in input units: what the program's inputs change by in that time
    wanted.time = robot.inputs.time;
    StepReport report;
    report.arrived = units_.distance(robot.inputs, wanted) <= no_change;
    if (!report.arrived) report.reason = "the inputs change, but a step in time must lead to a later time";
    return report;
}

StepReport Stepper::drive(RobotState& robot, const Inputs& wanted, const Progress& progress, const State* expected,
                          const std::function<void(double share)>& after_piece, int most_iterations) {
    for (std::size_t a = 0; a < steered(); ++a) {
        Drive& drive = robot.inputs.drives[a];
        if (drive.kind == wanted.drives[a].kind) continue;
        drive = hold(robot, a, wanted.drives[a].kind);
        robot.before.reset();
    }
    const Inputs begin = robot.inputs;
    const bool in_time = options_.dynamics.has_value();
    if (in_time && is_same_time(begin.time, wanted.time)) return stay(robot, wanted);
    if (in_time && !(wanted.time > begin.time)) {
        StepReport report;
        report.reason = "a step in time must lead to a later time";
        return report;
    }
    const double length = in_time ? wanted.time - begin.time : 1;
    const bool onward = in_time || set_course(robot, wanted);
    if (in_time) robot.now.along = begin.time;
    const double from = robot.now.along;
    const auto inputs_at = [&](double along) { return between(begin, wanted, (along - from) / length); };
    StepPath path{from + length, [&](double along) { return controls(robot, inputs_at(along)); },
                  (is_adaptive() ? smallest_adaptive_share : smallest_share) * length, onward, expected};
    path.most_iterations = most_iterations;
    if (after_piece) path.after_piece = [&](const RobotState& at) { after_piece((at.now.along - from) / length); };
    if (in_time) {
        const double longest = std::max(options_.time_unit, options_.dynamics->time_step_s);
        path.longest_piece = length / std::max(1.0, std::ceil(length / longest - rounding));
    }
    StepReport report = step(robot, path, progress);
    robot.inputs = report.arrived ? wanted : inputs_at(robot.now.along);
    if (report.pieces > 0) robot.before = inputs_at(robot.past.back().along);
    return report;
}

/// The step length is adapted to the error. If the next step would nearly reach the end of the path it is shortened, or
/// two are made equally long, so that none is very short.
StepReport Stepper::step_by_error(RobotState& robot, const StepPath& path, const Progress& progress) {
    constexpr double first_share = 1.0 / 64, most_growth = 2, most_loss = 0.2, careful = 0.9;
    const double tolerance = options_.dynamics->time_tolerance_m;
    StepReport report;
    std::string off;  // why the last solved step was rejected
    FailedAttempt last;
    int in_vain = 0;    // iterations of the attempts that failed since the last step that was not ever shorter
    double solved = 0;  // length of the last step that was solved
    const double very_short = smallest_share * options_.time_unit;
    double piece = robot.history.next_dt;
    if (!(piece > 0)) piece = first_share * (path.end - robot.now.along);
    while (robot.now.along < path.end && !progress.cancelled()) {
        const double rest = path.end - robot.now.along;
        const double dt = piece >= (1 - rounding) * rest ? rest : piece > 0.5 * rest ? 0.5 * rest : piece;
        const double end = dt == rest ? path.end : robot.now.along + dt;
        const bool shortest = !(dt > path.shortest_piece);
        double error = 0;
        const StepOutcome outcome =
            go(robot, {end, path.at(end), path.onward, end == path.end ? path.expected : nullptr, &error, tolerance},
               report, progress);
        const bool of_second_order = outcome.converged || error > 0;
        const double growth =
            of_second_order
                ? std::clamp(careful * std::cbrt(tolerance / std::max(error, 1e-3 * tolerance)), most_loss, most_growth)
                : 0.5;
        if (outcome.converged) {
            robot.history.next_dt = dt < piece && growth >= 1 ? std::max(piece, growth * dt) : growth * dt;
            piece = robot.history.next_dt;
            if (dt > very_short || dt >= solved) in_vain = 0;
            solved = dt;
            if (path.after_piece) path.after_piece(robot);
            continue;
        }
        ++report.refused;
        if (!of_second_order) in_vain += outcome.iterations;
        if (error > tolerance) off = outcome.reason;
        last = {off.empty() || error > tolerance
                    ? outcome.reason
                    : fmt::format("{}, and shorter ones are not solved: {}", off, outcome.reason),
                outcome.no_start};
        piece = std::min(growth, careful) * dt;
        // Where only shorter and shorter steps are solved, as in an impact on what is too soft, the end is never
        // reached.
        if (shortest || (dt < very_short && in_vain >= std::max(most_in_vain, options_.iteration_limit))) break;
    }
    conclude(robot.now.along, path.end, last, report);
    remember(robot);
    return report;
}

StepReport Stepper::step(RobotState& robot, const StepPath& path, const Progress& progress) {
    recall(robot);
    if (is_adaptive()) return step_by_error(robot, path, progress);
    StepReport report;
    const double longest = path.longest_piece > 0 ? path.longest_piece : path.end - robot.now.along;
    double piece = longest;
    int in_vain = 0;  // iterations of the attempts since the last one that succeeded
    FailedAttempt last;
    while (robot.now.along < path.end) {
        const int left = path.most_iterations - report.iterations;
        if (path.most_iterations > 0 && left <= 0) {
            last = {fmt::format("it takes more than {} iterations", path.most_iterations), false};
            break;
        }
        const double along = robot.now.along + piece;
        const double end = along >= path.end - rounding * path.shortest_piece ? path.end : along;
        const State* expected = end == path.end ? path.expected : nullptr;
        Target target{end, path.at(end), path.onward, expected};
        if (path.most_iterations > 0) target.iteration_limit = left;
        const StepOutcome outcome = go(robot, target, report, progress);
        if (outcome.converged) {
            in_vain = 0;
            if (path.longest_piece > 0) piece = longest;
            if (path.after_piece) path.after_piece(robot);
            continue;
        }
        last = {outcome.reason, outcome.no_start};
        piece *= 0.5;
        in_vain += outcome.iterations;
        if (piece >= path.shortest_piece && !is_hopeless(model_, options_, in_vain) && !progress.cancelled()) continue;
        if (!ends_by_relaxing(robot, path, report, progress)) break;
        if (path.after_piece) path.after_piece(robot);
    }
    conclude(robot.now.along, path.end, last, report);
    remember(robot);
    return report;
}

bool Stepper::ends_by_relaxing(RobotState& robot, const StepPath& path, StepReport& report, const Progress& progress) {
    if (!(tether_dt_s_ > 0) || progress.cancelled()) return false;
    const std::optional<State> relaxed = relax(robot, path.at(path.end), report, progress);
    return relaxed && go(robot, {path.end, path.at(path.end), path.onward, &*relaxed}, report, progress).converged;
}

/// Where parts that can swing or fall come to rest: implicit Euler steps without velocity, from a tether so strong that
/// they move by a tenth of the robot's size to the usual one. Each finds the minimum of the energy and of the square of
/// the motion, so the energy decreases from step to step.
std::optional<State> Stepper::relax(const RobotState& robot, Controls controls, StepReport& report,
                                    const Progress& progress) {
    constexpr double first_share = 0.01, least_share = 1e-4, loss = 0.25;
    constexpr int most_steps = 400;
    // Far swings take many iterations, long before they fail.
    const auto growth = [](int iterations) { return iterations <= 8 ? 2 : iterations <= 16 ? 1.2 : 0.8; };
    State at = follow_supports(system_, laplacian_, robot.now.state, controls);
    Controls last = robot.controls;
    double share = first_share;
    for (int k = 0; k < most_steps && share >= least_share && !progress.cancelled(); ++k) {
        Controls now = controls;
        now.met = robot.controls.met;
        now.inertia = motion_->inertia(MotionInTime::still(at.x), share * tether_dt_s_);
        now.joint_start = system_.joint_coordinates(at.x, last);
        State next = at;
        solvers_.restart();
        const StepOutcome outcome = settle(robot, now, next, progress, std::nullopt, options_.iteration_limit);
        report.iterations += outcome.iterations;
        if (!outcome.converged) {
            share *= loss;
            continue;
        }
        at = std::move(next);
        last = std::move(now);
        if (share == 1) return at;
        share = std::min(1.0, growth(outcome.iterations) * share);
    }
    return std::nullopt;
}

StepReport Stepper::leap(RobotState& robot, const StepPath& path, const Progress& progress) {
    recall(robot);
    StepReport report;
    const StepOutcome outcome = go(robot, {path.end, path.at(path.end), path.onward, path.expected}, report, progress);
    report.arrived = outcome.converged;
    report.no_start = outcome.no_start;
    if (!outcome.converged) report.reason = outcome.reason;
    remember(robot);
    return report;
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
           std::ranges::any_of(model_.description().joints, has_stop);
}

int Stepper::touching_after(const RobotState& robot, const State& next, const Controls& controls) const {
    const Touching there = system_.touching(next, controls);
    if (there.none()) return 0;
    const bool as_before = there.is_part_of(system_.touching(robot.now.state, robot.controls));
    return as_before ? std::max(robot.history.touching, 1) + 1 : 1;
}

/// Things that touch use formulas that dissipate unresolved motion, as in an impact. The step in which that begins, and
/// the two after it, do not use earlier states: the first may end just where the surfaces meet, so that only the second
/// takes the velocity away, and BDF2 looks back two steps.
Scheme Stepper::scheme(const RobotState& robot, const Controls& controls) const {
    constexpr int steps_of_impact = 3;
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

StepReport Stepper::settle_beside(RobotState& robot, State guess, const Progress& progress) {
    recall(robot);
    StepReport report;
    Controls controls = robot.controls;
    controls.drives = robot.drives;
    solvers_.restart();
    StepOutcome outcome = settle(robot, controls, guess, progress, std::nullopt, options_.iteration_limit);
    report.arrived = outcome.converged;
    report.loose = outcome.loose;
    report.reason = outcome.reason;
    report.iterations = outcome.iterations;
    report.solver = outcome.solver;
    note(outcome.history, robot.now.along, report);
    if (outcome.converged) {
        robot.now.state = std::move(guess);
        robot.controls = std::move(controls);
        robot.evaluation = std::move(outcome.evaluation);
        robot.past.clear();  // they belong to the old path
    }
    remember(robot);
    return report;
}

bool Stepper::find(const Controls& controls, State& state, const Progress& progress) {
    live_.reset();  // the solvers no longer hold the memory of any state
    state = follow_supports(system_, laplacian_, state, controls);
    if (!system_.evaluate(state, controls).possible()) return false;
    solvers_.restart();
    return solvers_.solve(system_, controls, {options_.tolerance, options_.iteration_limit}, state, progress).converged;
}

double Stepper::kinetic_energy_J(const RobotState& robot) const {
    return options_.dynamics ? motion_->kinetic_energy_J(robot.history) : 0;
}

std::shared_ptr<const Inertia> Stepper::inertia(const History& history, double dt, Scheme scheme) const {
    return motion_->inertia(history, dt, scheme);
}

void Stepper::release() {
    live_.reset();
    solvers_.release();
}

/// Restores the solvers' memory of when this state was computed.
void Stepper::recall(const RobotState& robot) {
    if (robot.memory && robot.memory == live_) return;
    solvers_.recall(robot.memory.get());
}

void Stepper::remember(RobotState& robot) {
    robot.memory = live_ = solvers_.memory();
}

}  // namespace pliant::sim
