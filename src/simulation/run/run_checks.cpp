#include "simulation/run/run_checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "base/core/boxes.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/run/left_open.hpp"
#include "simulation/run/warnings.hpp"
#include "simulation/solver/pressure_limit.hpp"
#include "simulation/stepper/prediction.hpp"

namespace pliant::sim {
namespace {

constexpr double sudden = 5;         // times the motion in the step before
constexpr double noticeable = 0.01;  // of the robot's size, as a mean of all nodes
constexpr double long_first = 0.03;  // likewise, for the first step, which has no step to compare with
constexpr int most_pushes = 5;
constexpr double extremely_soft = 100;  // a shape parameter
constexpr std::string_view not_left = "along its softest motion led to no stable one";

bool are_told(const std::vector<std::string>& warnings, std::string_view what) {
    return std::ranges::any_of(warnings,
                               [&](const std::string& warning) { return warning.find(what) != std::string::npos; });
}

/// What acts from the first instant on, as a stretched spring, a load that begins at once or the offset of a drive: the
/// robot leaps to it by the wish of the program's author. On the path from rest to the first step it grows from
/// nothing.
class SuddenStart {
public:
    /// `first`: controls just after rest.
    SuddenStart(const Equilibrium& system, const State& rest, const Controls& first) : lead_(first.drives.size(), 0.0) {
        const Evaluation now = system.evaluate(rest, first);
        if (!now.possible()) return;
        force_N_ = now.out_of_balance;
        for (std::size_t a = 0; a < lead_.size(); ++a) {
            const Actuator& actuator = system.actuators()[a];
            if (first.drives[a].kind != Drive::Kind::measure) continue;
            lead_[a] = actuator.measure(linalg::view(rest.x)) - first.drives[a].value;
            if (actuator.only_pulls()) lead_[a] = std::max(lead_[a], 0.0);  // else it is slack, and does not act
        }
    }

    /// The controls with this share of it, 0 to 1.
    [[nodiscard]] Controls with(double share, Controls controls) const {
        if (force_N_.size() > 0) controls.external_N += (1 - share) * force_N_;
        for (std::size_t a = 0; a < lead_.size(); ++a) controls.drives[a].value += (1 - share) * lead_[a];
        return controls;
    }

private:
    Eigen::VectorXd force_N_;   // (3n) out of balance at rest; empty: nothing
    std::vector<double> lead_;  // (actuators) of the measure at rest over the prescribed one
};

}  // namespace

RunChecks::RunChecks(Stepper& stepper, const Program& program, const RobotState& rest)
    : stepper_(stepper),
      system_(stepper.system()),
      program_(program),
      stability_(stepper.system(), stepper.laplacian()) {
    state_.reported = rest.now;
    size_ = bounds_of(stepper.model().mesh().points).diagonal();
}

void RunChecks::after_step(RobotState& robot, Step& step, StepReport& report, std::vector<std::string>& warnings,
                           const Progress& progress) {
    if (program_.dynamics) return;
    if (jumped(robot, progress)) {
        if (step.index > 1) state_.before_jump.push_back(static_cast<std::size_t>(step.index) - 1);
        warnings.push_back(
            fmt::format("at step {} the robot jumps: between two states near each other there is no equilibrium that "
                        "leads from one to the other; what it does in between takes time, and the state after it may "
                        "be another one in reality",
                        step.index));
    }
    if (program_.imperfection_m > 0) {
        const auto motion = stability_.falling_motion(robot.now.state, robot.controls);
        if (motion && leave(robot, *motion, report, progress))
            warnings.push_back(
                fmt::format("at step {} the equilibrium is unstable; a push of {:.3g} mm along its softest motion led "
                            "to a stable one",
                            step.index, 1e3 * program_.imperfection_m));
        else if (motion && !progress.cancelled() && !are_told(warnings, not_left))
            warnings.push_back(fmt::format("at step {} the equilibrium is unstable, and a push of {:.3g} mm or more {}",
                                           step.index, 1e3 * program_.imperfection_m, not_left));
    }
    state_.reported = robot.now;
}

/// A step that is much larger than the one before it, or a large first one, is checked for a jump.
bool RunChecks::jumped(const RobotState& robot, const Progress& progress) {
    const double way = (robot.x() - state_.reported.state.x).norm();
    const double before = std::exchange(state_.last_way, way);
    if (!stability_.is_applicable() || system_.has_cable_friction() || system_.has_friction()) return false;
    const double reach = std::sqrt(static_cast<double>(robot.x().size() / 3)) * size_;
    const bool first = !(before > 0);
    if (first ? !program_.checks || way < long_first * reach : way < sudden * before || way < noticeable * reach)
        return false;
    const auto at = [&](double time) { return stepper_.controls(robot, time); };
    std::optional<SuddenStart> start;
    if (state_.reported.along == 0) {
        constexpr double instant = 1e-6;  // of the step: offsets act from there on, not at rest
        start.emplace(system_, state_.reported.state, at(instant * robot.now.along));
    }
    return is_jump(state_.reported, robot.now, [&](double time, State& state) {
        return stepper_.find(start ? start->with(time / robot.now.along, at(time)) : at(time), state, progress);
    });
}

/// Disturbs the state along `motion`, increasingly until it does not return; false if no disturbance leads to a stable
/// state.
bool RunChecks::leave(RobotState& robot, const Eigen::VectorXd& motion, StepReport& report, const Progress& progress) {
    double push = program_.imperfection_m;
    for (int k = 0; k < most_pushes && !progress.cancelled(); ++k, push *= 4) {
        State pushed = robot.now.state;
        system_.add_free(motion, push, pushed.x);
        if (!system_.evaluate(pushed, robot.controls).possible() || !passes(system_, robot, pushed, robot.controls))
            return false;
        RobotState beside = robot;
        const StepReport settled = stepper_.settle_beside(beside, std::move(pushed), progress);
        robot.memory = beside.memory;  // makes the next attempt faster
        report.iterations += settled.iterations;
        report.history.insert(report.history.end(), settled.history.begin(), settled.history.end());
        if (!settled.arrived || stability_.falling_motion(beside.now.state, beside.controls)) continue;
        robot = std::move(beside);
        return true;
    }
    return false;
}

void RunChecks::warn_of_closed_gaps(const RobotState& robot, int step, std::vector<std::string>& warnings) {
    for (const ClosedGap& gap : closed_gaps(system_, robot.x())) {
        if (!state_.warned.insert(gap.cable).second) continue;
        warnings.push_back(fmt::format("from step {} on, {}", step, closed_gap_text(system_.model(), gap)));
    }
}

void RunChecks::warn_of_uncarried_loads(const RobotState& robot, int step, std::vector<std::string>& warnings) const {
    constexpr double noticeable_share = 0.01;
    constexpr std::string_view what = "the loads are not carried";
    const Evaluation& now = robot.evaluation;
    const Eigen::VectorXd& loads = robot.controls.external_N;
    const bool loaded = system_.restrict_to_free(loads).norm() > 0;
    if (program_.dynamics || !loaded || now.residual > program_.tolerance || !now.multiplier.isZero(0)) return;
    const double largest = std::max((now.out_of_balance + loads).norm(), loads.norm());
    const double open = system_.restrict_to_free(now.out_of_balance).norm();
    if (!(open > std::max(noticeable_share, 2 * program_.tolerance) * largest)) return;
    if (are_told(warnings, what)) return;
    warnings.push_back(
        fmt::format("from step {} on {}: {:.2g} % of the forces are out of balance, and too small beside the stiffest "
                    "material to be told from rounding errors; bring the moduli nearer to each other, or leave out "
                    "what hardly deforms",
                    step, what, 100 * open / largest));
}

void RunChecks::look_for_crossings(const RobotState& robot, std::vector<Step>& steps, bool last) const {
    constexpr int interval = 32;
    const auto look = [&](Step& step) {
        step.crossing_m = system_.crossing(state_of(step), stepper_.controls(robot, step.time));
        return step.crossing_m.has_value();
    };
    const std::size_t end = steps.size() - 1;
    const bool crossed = end > 0 && steps[end - 1].crossing_m;
    if (!program_.checks || (!last && !crossed && end % interval != 0)) return;
    for (std::size_t k = end; k > 0 && look(steps[k]) && !steps[k - 1].crossing_m;) --k;
}

void RunChecks::warn_of_open_places(const RobotState& robot, Trajectory& result) const {
    if (program_.dynamics || result.steps.size() < 2) return;
    if (const std::string open = left_open(system_, robot.now.state, robot.controls); !open.empty())
        result.warnings.push_back(
            fmt::format("at the end the equilibrium leaves open where some things are, and a weak tether to the step "
                        "before holds them there: {}",
                        open));
}

void RunChecks::at_end(const RobotState& robot, Trajectory& result) {
    warn_of_open_places(robot, result);
    const bool pushed = program_.imperfection_m > 0;  // then each step was checked, and what is unstable was left
    if (!program_.checks || program_.dynamics || result.steps.size() < 2) return;
    if (pushed && !are_told(result.warnings, not_left)) return;
    stepper_.release();  // the check of stability makes a factor of its own, of the same size
    std::vector<std::size_t> suspects = state_.before_jump;
    suspects.push_back(result.steps.size() - 1);
    for (const std::size_t suspect : suspects) {
        if (!is_unstable(robot, result.steps[suspect])) continue;
        std::size_t stable = 0, unstable = suspect;
        while (unstable - stable > 1) {
            const std::size_t middle = (stable + unstable) / 2;
            (is_unstable(robot, result.steps[middle]) ? unstable : stable) = middle;
        }
        const bool jumps = suspect + 1 < result.steps.size();
        result.warnings.push_back(fmt::format(
            "from step {} on the equilibrium is unstable{}: a real robot buckles or tips to one side where this "
            "one stays in balance; {}program.imperfection follows the stable way",
            unstable, jumps ? fmt::format(", until the robot jumps in step {}", suspect + 1) : "",
            pushed ? "perhaps another " : ""));
        return;
    }
}

/// The state of a recorded step, without multipliers.
State RunChecks::state_of(const Step& step) const {
    State state = system_.rest();
    for (std::size_t n = 0; n < step.positions.size(); ++n) {
        const Vec3& p = step.positions[n];
        state.x.segment<3>(3 * static_cast<Eigen::Index>(n)) << p.x, p.y, p.z;
    }
    return state;
}

bool RunChecks::is_unstable(const RobotState& robot, const Step& step) {
    State state = state_of(step);
    Eigen::Index a = 0;
    for (const CableState& cable : step.cables) state.multiplier[a++] = cable.tension_N;
    for (const ChamberState& chamber : step.chambers) state.multiplier[a++] = -chamber.pressure_Pa;
    Controls controls = stepper_.controls(robot, step.time);
    for (std::size_t j = 0; j < step.joints.size(); ++j)  // with their whole turns in that step
        controls.joint_start[j] = step.joints[j].coordinate;
    // Without the tether what nothing holds would have no stiffness at all, and rounding errors would decide.
    if (stepper_.has_inertia()) controls.inertia = robot.controls.inertia;
    state.multiplier = system_.evaluate(state, controls).multiplier;
    return stability_.falling_motion(state, controls).has_value();
}

namespace {

/// What touches what, as "object "a" touches obstacle "wall"", at most three of them; `how`: "touches", or what they do
/// instead.
std::string touching_text(const Description& d, std::span<const std::array<int, 2>> surfaces, std::string_view how) {
    constexpr std::size_t most = 3;
    const auto name = [&](int owner) {
        if (owner == 0) return std::string("the robot");
        return owner > 0 ? "object \"" + d.objects[static_cast<std::size_t>(owner) - 1].name + "\""
                         : "obstacle \"" + d.contact->obstacles[static_cast<std::size_t>(-owner) - 1].body.name + "\"";
    };
    std::vector<std::string> texts;
    for (const auto& [low, high] : surfaces.first(std::min(most, surfaces.size())))
        texts.push_back(low == 0 && high == 0 ? fmt::format("the robot {} itself", how)
                                              : fmt::format("{} {} {}", name(high), how, name(low)));
    if (surfaces.size() > most) texts.push_back("and more");
    return fmt::format("{}", fmt::join(texts, ", "));
}

/// What the motion of everything, obstacles too, leads to within two steps: what meets first, as of Touching::surfaces.
/// The search for the end of a free motion takes no memory for what is merely near, and each pair its own velocity. The
/// robot with itself does not count: its own velocities are those of a deformation, which does not go on.
std::vector<std::array<int, 2>> meeting_next(const Stepper& stepper, const RobotState& robot) {
    constexpr double steps = 2;
    constexpr int most_rounds = 12;  // each ends at a tenth of the distance
    const Equilibrium& system = stepper.system();
    State state = robot.now.state;
    Controls controls = robot.controls;
    const double ahead_s = steps * stepper.options().time_unit;
    Eigen::VectorXd way = ahead_s * robot.history.v;
    Eigen::VectorXd obstacles = stepper.controls(robot, controls.time + ahead_s).obstacles - controls.obstacles;
    for (int round = 0; round < most_rounds; ++round) {
        const double free = system.largest_step(state.x, way, controls, obstacles);
        if (!(free < 1)) return {};
        state.x += free * way;
        controls.obstacles += free * obstacles;
        way *= 1 - free;
        obstacles *= 1 - free;
        std::vector<std::array<int, 2>> surfaces = system.touching(state, controls).surfaces;
        std::erase(surfaces, std::array{0, 0});
        if (!surfaces.empty()) return surfaces;
    }
    return {};
}

/// For a motion in time that stops: a contact that is too soft and too thin to stop what hits it is squeezed until the
/// forces grow without bound.
std::string advice_on_impact(const Stepper& stepper, const RobotState& robot) {
    const Equilibrium& system = stepper.system();
    const Description& d = stepper.model().description();
    const contact::Contact* contact = stepper.model().contact(robot.controls.met);
    if (contact == nullptr || !robot.controls.inertia) return {};
    auto surfaces = system.touching(robot.now.state, robot.controls).surfaces;
    const bool touches = !surfaces.empty();
    if (!touches) surfaces = meeting_next(stepper, robot);
    if (surfaces.empty()) return {};
    return fmt::format(
        ". Here {}, and the contact may be too soft and too thin to stop what moves: a larger contact.stiffness (now "
        "{:.3g} kPa) or contact.distance (now {:.3g} mm) helps, sometimes also a smaller program.time_step",
        touching_text(d, surfaces, touches ? "touches" : "is about to touch"), 1e-3 * contact->settings().stiffness_Pa,
        1e3 * contact->settings().distance_m);
}

}  // namespace

std::string advice(Stepper& stepper, const Program& program, const RobotState& robot, double time,
                   const Progress& progress) {
    if (progress.cancelled()) return {};
    const Description& d = stepper.model().description();
    for (const Material& material : d.materials) {
        const auto* blend = std::get_if<material::ShapeBlend>(&material.law);
        if (blend != nullptr && blend->a * extremely_soft < 1 - 1e-9)
            return fmt::format(
                ". Material \"{}\" has a shape parameter of {:.4g}, of which hardly anything but the volume is kept: "
                "with {:g} or less a solution is far easier to find",
                material.name, 1 / blend->a, extremely_soft);
    }
    if (program.dynamics) return advice_on_impact(stepper, robot);
    if (!d.growths.empty()) return {};
    if (stepper.system().has_friction() && stepper.has_inertia())
        return ". Only friction holds something here: where it is too weak there is no equilibrium, and the thing "
               "slides; with program.time_step its motion is computed";
    const auto limit =
        find_pressure_limit(stepper.system(), stepper.solvers(), robot.controls, stepper.controls(robot, time),
                            {program.tolerance, program.iteration_limit}, robot.now.state, progress);
    if (!limit) return {};
    return fmt::format(
        ". No equilibrium was found above {:.4g} kPa in chamber \"{}\": its pressure has a maximum of {:.4g} kPa at "
        "volume ratio {:.3g}, and with more air in it the pressure falls. Drive it by volume_ratio to pass this limit",
        1e-3 * limit->reached_Pa, d.chambers[limit->chamber].name, 1e-3 * limit->largest_Pa, limit->volume_ratio);
}

}  // namespace pliant::sim
