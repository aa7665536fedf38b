#include "simulation/stepper/stepper.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "base/core/boxes.hpp"
#include "simulation/stepper/prediction.hpp"
#include "simulation/stepper/step_piece.hpp"

namespace pliant::sim {
namespace {

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
                  (is_adaptive() ? smallest_adaptive_share : smallest_piece) * length, onward, expected};
    path.most_iterations = most_iterations;
    if (after_piece) path.after_piece = [&](const RobotState& at) { after_piece((at.now.along - from) / length); };
    if (in_time) {
        const double longest = std::max(options_.time_unit, options_.dynamics->time_step_s);
        path.longest_piece = length / std::max(1.0, std::ceil(length / longest - piece_rounding));
    }
    StepReport report = step(robot, path, progress);
    robot.inputs = report.arrived ? wanted : inputs_at(robot.now.along);
    if (report.pieces > 0) robot.before = inputs_at(robot.past.back().along);
    return report;
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
