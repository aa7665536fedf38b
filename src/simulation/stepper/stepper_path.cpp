// A step in pieces: halved where one is not solved, or as long as the error in time allows.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "simulation/elements/elements.hpp"
#include "simulation/stepper/prediction.hpp"
#include "simulation/stepper/step_piece.hpp"

namespace pliant::sim {
namespace {

constexpr int most_in_vain = 3000;  // iterations: as many as quasi-newton may take for one attempt

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

}  // namespace

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
    const double very_short = smallest_piece * options_.time_unit;
    double piece = robot.history.next_dt;
    if (!(piece > 0)) piece = first_share * (path.end - robot.now.along);
    while (robot.now.along < path.end && !progress.cancelled()) {
        const double rest = path.end - robot.now.along;
        const double dt = piece >= (1 - piece_rounding) * rest ? rest : piece > 0.5 * rest ? 0.5 * rest : piece;
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
        const double end = along >= path.end - piece_rounding * path.shortest_piece ? path.end : along;
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

}  // namespace pliant::sim
