#include "simulation/run/simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "simulation/elements/elements.hpp"
#include "simulation/run/describe.hpp"
#include "simulation/run/stability.hpp"
#include "simulation/run/warnings.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/solver/friction_rounds.hpp"
#include "simulation/solver/prescribed_approach.hpp"
#include "simulation/solver/pressure_limit.hpp"
#include "simulation/solver/solver_chain.hpp"

namespace pliant::sim {
namespace {

constexpr double smallest_share = 1.0 / 64;  // of a step of the program

// Errors of states to start from. Beyond the worst the body buckles or something new begins to act: from where it is,
// at least its tangent is sound.
constexpr double worst_start = 0.2;
constexpr double good_start = 0.03;

constexpr int friction_rounds = 30;
constexpr double sudden = 5;         // times as far as in the step before
constexpr double noticeable = 0.01;  // of the robot's size, as a mean of all nodes
constexpr double long_first = 0.03;  // likewise: no step before tells whether the first one is sudden
constexpr int most_pushes = 5;
constexpr double extremely_soft = 100;  // a shape parameter
constexpr int most_in_vain = 3000;      // iterations, as quasi-newton may take for one attempt

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The walk through the program: the last two converged states and the solver.
class Run {
public:
    Run(const Model& model, const Program& program)
        : model_(model),
          program_(program),
          system_(model),
          laplacian_(system_),
          stability_(system_, laplacian_),
          solvers_(make_chain(program.solver, system_, laplacian_)),
          state_(system_.rest()),
          controls_(system_.controls(0)) {
        const Eigen::VectorXd still = Eigen::VectorXd::Zero(state_.x.size());
        history_ = {state_.x, still, state_.x, still, 0};
        reported_ = {0, state_};
        Box3 box;
        for (const Vec3& p : model.mesh().points) box.add(p);
        size_ = box.diagonal();
    }

    [[nodiscard]] std::string_view solver_name() const { return name(solvers_.first()); }

    /// Goes to `time` in as many pieces as it takes. False: stuck; `message` says why.
    bool advance(double time, Step& step, const Progress& progress, std::string& message) {
        const double whole = program_.duration / program_.steps;
        double piece = time - time_;
        int in_vain = 0;  // iterations of the attempts since the last that arrived
        step.substeps = 0;
        while (time_ < time) {
            const double target = time_ + piece >= time - 1e-9 * whole ? time : time_ + piece;
            State next = state_;
            const StepOutcome outcome = attempt(target, next, progress);
            step.iterations += outcome.iterations;
            note(outcome.history, step.index, target);
            if (outcome.converged && system_.meets_itself(state_, controls_, next, solved_controls_)) {
                system_.set_met(true);
                controls_.met = true;
                continue;
            }
            if (outcome.converged) {
                if (program_.dynamics) remember(next, target - time_);
                past_.push_back({time_, std::move(state_)});
                if (past_.size() > RotatingStep::most_past) past_.pop_front();
                state_ = std::move(next);
                controls_ = solved_controls_;
                time_ = target;
                evaluation_ = outcome.evaluation;
                step.solver = outcome.solver;
                if (outcome.loose) note_loose(outcome, step);
                ++step.substeps;
                in_vain = 0;
                continue;
            }
            message = outcome.reason;
            piece *= 0.5;
            in_vain += outcome.iterations;
            if (progress.cancelled() || piece < smallest_share * whole || is_hopeless(in_vain)) return false;
        }
        return true;
    }

    /// Laws without an energy promise no descent, however short the step is: where as many iterations as one attempt
    /// may take have led nowhere, more of them do not either.
    [[nodiscard]] bool is_hopeless(int in_vain) const {
        return !model_.elements().has_energy() && in_vain >= std::max(most_in_vain, program_.iteration_limit);
    }

    [[nodiscard]] std::vector<IterationRecord> take_iterations() { return std::move(iterations_); }

    /// What a program that stopped before `time` should do instead; empty if nothing is known.
    [[nodiscard]] std::string advice(double time, const Progress& progress) {
        if (progress.cancelled()) return {};
        for (const Material& material : model_.description().materials) {
            const auto* blend = std::get_if<material::ShapeBlend>(&material.law);
            if (blend != nullptr && blend->a * extremely_soft < 1 - 1e-9)
                return fmt::format(
                    ". Material \"{}\" has a shape parameter of {:.4g}, of which hardly anything but the volume is "
                    "kept: with {:g} or less a solution is far easier to find",
                    material.name, 1 / blend->a, extremely_soft);
        }
        if (program_.dynamics || !model_.description().growths.empty() || progress.cancelled()) return {};
        const auto limit = find_pressure_limit(system_, solvers_, controls_, system_.controls(time),
                                               {program_.tolerance, program_.iteration_limit}, state_, progress);
        if (!limit) return {};
        return fmt::format(
            ". No equilibrium was found above {:.4g} kPa in chamber \"{}\": its pressure has a maximum of {:.4g} kPa "
            "at "
            "volume ratio {:.3g}, and with more air in it the pressure falls. Drive it by volume_ratio to pass this "
            "limit",
            1e-3 * limit->reached_Pa, model_.description().chambers[limit->chamber].name, 1e-3 * limit->largest_Pa,
            limit->volume_ratio);
    }

    void describe(Step& step) const {
        sim::describe(model_, system_, state_, controls_, evaluation_, step);
        if (program_.dynamics) step.kinetic_energy_J = kinetic_energy();
    }

    [[nodiscard]] double kinetic_energy() const {
        Eigen::VectorXd momentum = Eigen::VectorXd::Zero(history_.v.size());
        model_.elements().apply_mass({history_.v.data(), static_cast<std::size_t>(history_.v.size())},
                                     {momentum.data(), static_cast<std::size_t>(momentum.size())});
        return 0.5 * history_.v.dot(momentum);
    }

    /// A gap that has closed between two guide points: from here on the flanks would touch.
    void warn_of_closed_gaps(int step, std::vector<std::string>& warnings) {
        if (const auto* contact = model_.contact(true); contact != nullptr && contact->settings().self) return;
        const std::span<const double> x(state_.x.data(), static_cast<std::size_t>(state_.x.size()));
        for (std::size_t c = 0; c < system_.cable_count(); ++c) {
            const int segment = system_.actuators()[c].cable().closed_segment(x);
            if (segment < 0 || !warned_.insert(c).second) continue;
            warnings.push_back(fmt::format("from step {} on, {}", step,
                                           closed_gap_text(model_.description().cables[c].name, segment)));
        }
    }

    /// Of a robot at rest at every instant, after each step: whether it jumped on the way. If the program says by how
    /// much to push it, it also goes on from where it is unstable to where it is stable.
    void check_stability(Step& step, std::vector<std::string>& warnings, const Progress& progress) {
        if (program_.dynamics) return;
        if (jumped(progress)) {
            if (step.index > 1) before_jump_.push_back(static_cast<std::size_t>(step.index) - 1);
            warnings.push_back(
                fmt::format("at step {} the robot jumps: between two states near each other there is no "
                            "equilibrium that leads from one to the other; what it does in between takes "
                            "time, and the state after it may be another one in reality",
                            step.index));
        }
        if (program_.imperfection_m > 0) {
            const auto motion = stability_.falling_motion(state_, controls_);
            if (motion && leave(*motion, step, progress))
                warnings.push_back(
                    fmt::format("at step {} the equilibrium is unstable; a push of {:.3g} mm along its softest "
                                "motion led to a stable one",
                                step.index, 1e3 * program_.imperfection_m));
        }
        reported_ = {time_, state_};
    }

    /// Whether surfaces have passed through each other: looked for in every 32nd step and the last, as a search takes
    /// half as long as a step, and from one in which they have back to the last in which they had not.
    void look_for_crossings(std::vector<Step>& steps, bool last) const {
        constexpr int interval = 32;
        const auto look = [&](Step& step) {
            step.crossing_m = system_.crossing(state_of(step), system_.controls(step.time));
            return step.crossing_m.has_value();
        };
        const std::size_t end = steps.size() - 1;
        const bool crossed = end > 0 && steps[end - 1].crossing_m;
        if (!program_.checks || (!last && !crossed && end % interval != 0)) return;
        for (std::size_t k = end; k > 0 && look(steps[k]) && !steps[k - 1].crossing_m;) --k;
    }

    /// At the end: whether the last state is stable, and those before a jump. Of the first that is not, the first step
    /// that was not is sought by halving; a look at every step would take as long as the steps.
    void check_stability_at_end(Trajectory& result) {
        if (!program_.checks || program_.dynamics || program_.imperfection_m > 0 || result.steps.size() < 2) return;
        before_jump_.push_back(result.steps.size() - 1);
        for (const std::size_t suspect : before_jump_) {
            if (!is_unstable(result.steps[suspect])) continue;
            std::size_t stable = 0, unstable = suspect;
            while (unstable - stable > 1) {
                const std::size_t middle = (stable + unstable) / 2;
                (is_unstable(result.steps[middle]) ? unstable : stable) = middle;
            }
            const bool jumps = suspect + 1 < result.steps.size();
            result.warnings.push_back(
                fmt::format("from step {} on the equilibrium is unstable{}: a real robot buckles to one side where "
                            "this one stays in "
                            "balance; program.imperfection follows the stable way",
                            unstable, jumps ? fmt::format(", until the robot jumps in step {}", suspect + 1) : ""));
            return;
        }
    }

    void evaluate_rest() { evaluation_ = system_.evaluate(state_, controls_); }

private:
    /// What a step has told of its state, without multipliers.
    [[nodiscard]] State state_of(const Step& step) const {
        State state = system_.rest();
        for (std::size_t n = 0; n < step.positions.size(); ++n) {
            const Vec3& p = step.positions[n];
            state.x.segment<3>(3 * static_cast<Eigen::Index>(n)) << p.x, p.y, p.z;
        }
        return state;
    }

    [[nodiscard]] bool is_unstable(const Step& step) {
        State state = state_of(step);
        Eigen::Index a = 0;
        for (const CableState& cable : step.cables) state.multiplier[a++] = cable.tension_N;
        for (const ChamberState& chamber : step.chambers) state.multiplier[a++] = -chamber.pressure_Pa;
        const Controls controls = system_.controls(step.time);
        state.multiplier = system_.evaluate(state, controls).multiplier;
        return stability_.falling_motion(state, controls).has_value();
    }

    /// A step that is much quicker than the one before it, or a long first one, is looked at closely.
    [[nodiscard]] bool jumped(const Progress& progress) {
        const double way = (state_.x - reported_.state.x).norm();
        const double before = std::exchange(last_way_, way);
        if (!stability_.is_applicable() || system_.has_cable_friction() || system_.has_friction()) return false;
        const double reach = std::sqrt(static_cast<double>(state_.x.size() / 3)) * size_;
        const bool first = !(before > 0);
        if (first ? !program_.checks || way < long_first * reach : way < sudden * before || way < noticeable * reach)
            return false;
        return is_jump(reported_, {time_, state_}, [&](double time, State& state) {
            Controls controls = system_.controls(time);
            state = follow_supports(state, controls);
            if (!system_.evaluate(state, controls).possible()) return false;
            solvers_.restart();
            return solvers_.solve(system_, controls, {program_.tolerance, program_.iteration_limit}, state, progress)
                .converged;
        });
    }

    /// Pushes the state along `motion`, harder until it does not come back; false if no push leads to a stable one.
    [[nodiscard]] bool leave(const Eigen::VectorXd& motion, Step& step, const Progress& progress) {
        double push = program_.imperfection_m;
        for (int k = 0; k < most_pushes && !progress.cancelled(); ++k, push *= 4) {
            State next = state_;
            system_.add_free(motion, push, next.x);
            Controls controls = controls_;
            if (!system_.evaluate(next, controls).possible() || !passes(next, controls)) return false;
            solvers_.restart();
            const StepOutcome outcome = settle(controls, next, progress);
            step.iterations += outcome.iterations;
            note(outcome.history, step.index, time_);
            if (!outcome.converged || stability_.falling_motion(next, controls)) continue;
            state_ = std::move(next);
            controls_ = solved_controls_;
            evaluation_ = outcome.evaluation;
            past_.clear();  // they lead along the way that was left
            return true;
        }
        return false;
    }

    static void note_loose(const StepOutcome& outcome, Step& step) {
        step.converged = false;
        step.reason = outcome.reason;
    }

    void note(const std::vector<IterationRecord>& history, int step, double time) {
        for (IterationRecord record : history) {
            record.step = step;
            record.time = time;
            iterations_.push_back(record);
        }
    }

    [[nodiscard]] std::shared_ptr<const Inertia> make_inertia(double dt) {
        const Damping& damping = program_.dynamics->damping;
        std::shared_ptr<StiffnessMatrix> stiffness;
        if (damping.stiffness_s > 0) {
            if (!body_layout_) body_layout_ = make_body_layout();
            stiffness = std::make_shared<StiffnessMatrix>();
            stiffness->pattern = &body_layout_->pattern;
            stiffness->values.assign(body_layout_->pattern.entries(), 0.0);
            const std::span<const double> x(state_.x.data(), static_cast<std::size_t>(state_.x.size()));
            model_.elements().add_tangent(x, body_layout_->element_sums, stiffness->values, true);
        }
        return std::make_shared<const Inertia>(model_.elements(), model_.free_index(), history_, dt, damping,
                                               std::move(stiffness));
    }

    /// Of the elements alone: what damping by stiffness couples.
    [[nodiscard]] TangentLayout make_body_layout() const {
        const auto& index = model_.free_index();
        TangentLayout layout{linalg::make_pattern(model_.free_count(), 3, model_.elements().cliques(index)), {}};
        layout.element_sums = model_.elements().block_sums(index, layout.pattern);
        return layout;
    }

    void remember(const State& next, double dt) {
        History now{next.x, solved_controls_.inertia->velocity(next.x), history_.x, history_.v, dt};
        history_ = std::move(now);
    }

    StepOutcome attempt(double time, State& next, const Progress& progress) {
        Controls controls = system_.controls(time);
        if (program_.dynamics) controls.inertia = make_inertia(time - time_);
        StepOutcome outcome;
        Evaluation known;
        outcome.reason = predict(time, controls, next, known, progress);
        if (!outcome.reason.empty()) return outcome;
        solvers_.restart();
        return settle(controls, next, progress, std::move(known));
    }

    /// Starts from where the last states lead or, where that would turn a tet inside out or pass through something,
    /// from the last state with the supports at their new place, or with the robot pushed out of the way of what comes;
    /// `known` is its evaluation. Returns why there is no start.
    [[nodiscard]] std::string predict(double time, const Controls& controls, State& next, Evaluation& known,
                                      const Progress& progress) const {
        if (extrapolate(time, controls, next, known)) return {};
        next = follow_supports(state_, controls);
        known = system_.evaluate(next, controls);
        const bool possible = known.possible();
        if (possible && passes(next, controls)) return {};
        const std::string flaw(name(known.flaw));
        next = state_;
        if (model_.contact(controls.met) != nullptr &&
            approach(system_, laplacian_, controls_, controls, next, progress)) {
            known = system_.evaluate(next, controls);
            if (known.possible()) return {};
        }
        return possible ? "the prescribed motion passes through something in one go"
                        : fmt::format("the prescribed motion {}", flaw);
    }

    /// On from the last four states or, if that ends far from equilibrium, from fewer, whichever is nearest; `known` is
    /// the evaluation of `next`. False: none is near enough.
    [[nodiscard]] bool extrapolate(double time, const Controls& controls, State& next, Evaluation& known) const {
        double least = worst_start;
        for (std::size_t count = past_.size() + 1; count >= 2 && least > good_start; --count) {
            State state = onward(time, count, controls);
            if (!passes(state, controls)) continue;  // first: contact then knows whether anything is near at its end
            Evaluation e = system_.evaluate(state, controls);
            if (!e.possible() || !(e.error() < least)) continue;
            least = e.error();
            next = std::move(state);
            known = std::move(e);
        }
        return least < worst_start;
    }

    /// On along the polynomial through the last `count` states, at least 2: the multipliers as they are, and for each
    /// tet how far it has turned and grown. A bent body keeps its length so, where its nodes, on straight lines, would
    /// stretch it.
    [[nodiscard]] State onward(double time, std::size_t count, const Controls& controls) const {
        const std::vector<double> shares = shares_at(time, count);
        State next{state_.x, shares[0] * state_.multiplier};
        system_.place_supports(controls, next.x);
        RotatingStep rotating{.now = state_.x.data(), .end = next.x.data()};
        double beyond = 0;  // the shares of all states before the turn in question
        for (std::size_t k = count - 1; k > 0; --k) {
            const State& before = past_[past_.size() - k].state;
            next.multiplier += shares[k] * before.multiplier;
            beyond += shares[k];
            rotating.past[k - 1] = before.x.data();
            rotating.weights[k - 1] = -beyond;
        }
        next.x = laplacian_.rotate(system_, rotating);
        for (std::size_t c = 0; c < system_.cable_count(); ++c) {
            double& tension = next.multiplier[static_cast<Eigen::Index>(c)];
            if (system_.actuators()[c].only_pulls()) tension = std::max(tension, 0.0);
        }
        return next;
    }

    /// Lagrange's polynomials for the last `count` states, the latest first, at a time: they sum up to 1.
    [[nodiscard]] std::vector<double> shares_at(double time, std::size_t count) const {
        const auto time_of = [&](std::size_t k) { return k == 0 ? time_ : past_[past_.size() - k].time; };
        std::vector<double> shares(count, 1.0);
        for (std::size_t k = 0; k < count; ++k) {
            for (std::size_t other = 0; other < count; ++other) {
                if (other != k) shares[k] *= (time - time_of(other)) / (time_of(k) - time_of(other));
            }
        }
        return shares;
    }

    /// True if the way from the last state to `next` meets nothing.
    [[nodiscard]] bool passes(const State& next, const Controls& controls) const {
        return system_.largest_step(state_.x, next.x - state_.x, controls_, controls.obstacles - controls_.obstacles) >=
               1;
    }

    /// `known`: of `next`, as long as there is no friction.
    StepOutcome settle(Controls& controls, State& next, const Progress& progress,
                       std::optional<Evaluation> known = {}) {
        const std::vector<Drive> before = system_.controls(time_).drives;
        const StepSettings settings{program_.tolerance, program_.iteration_limit};
        StepOutcome outcome = settle_friction(system_, solvers_, settings, friction_rounds, {state_, controls_, before},
                                              controls, next, progress, std::move(known));
        solved_controls_ = controls;
        return outcome;
    }

    [[nodiscard]] State follow_supports(const State& from, const Controls& controls) const {
        State next = from;
        system_.place_supports(controls, next.x);
        const Eigen::VectorXd motion = next.x - from.x;
        if (motion.squaredNorm() > 0) system_.add_free(laplacian_.follow(system_, motion), 1, next.x);
        return next;
    }

    const Model& model_;
    const Program& program_;
    Equilibrium system_;
    FactoredLaplacian laplacian_;
    Stability stability_;
    SolverChain solvers_;
    State state_;
    std::deque<Moment> past_;   ///< the states before it
    Controls controls_;         ///< of the last converged state
    Controls solved_controls_;  ///< of the state that was solved last
    double time_ = 0;
    Evaluation evaluation_;
    History history_;                           ///< of a motion in time
    std::optional<TangentLayout> body_layout_;  ///< made when damping by stiffness first needs it
    std::set<std::size_t> warned_;              ///< cables
    Moment reported_;                           ///< after the last step of the program
    double last_way_ = 0;                       ///< that this step took
    std::vector<std::size_t> before_jump_;      ///< steps
    double size_ = 0;                           ///< of the robot at rest
    std::vector<IterationRecord> iterations_;
};

}  // namespace

Trajectory run(const Model& model, const Program& program, Progress& progress) {
    Trajectory result;
    const auto start = std::chrono::steady_clock::now();
    Run walk(model, program);
    result.solver = walk.solver_name();
    result.warnings = warnings_at_rest(model);
    Step rest;
    walk.evaluate_rest();
    walk.describe(rest);
    result.steps.push_back(std::move(rest));
    result.setup_s = seconds_since(start);
    for (int k = 1; k <= program.steps; ++k) {
        progress.advance("simulate", static_cast<double>(k - 1) / program.steps);
        const auto begin = std::chrono::steady_clock::now();
        Step step;
        step.index = k;
        step.time = program.duration * static_cast<double>(k) / program.steps;
        std::string message;
        const bool arrived = !progress.cancelled() && walk.advance(step.time, step, progress, message);
        if (!arrived) {
            result.converged = false;
            result.message = progress.cancelled() ? fmt::format("cancelled at step {} of {}", k, program.steps)
                                                  : fmt::format("stopped at step {} of {}: {}{}", k, program.steps,
                                                                message, walk.advice(step.time, progress));
            break;
        }
        walk.check_stability(step, result.warnings, progress);
        walk.describe(step);
        walk.warn_of_closed_gaps(k, result.warnings);
        step.wall_s = seconds_since(begin);
        result.solve_s += step.wall_s;
        result.steps.push_back(std::move(step));
        walk.look_for_crossings(result.steps, false);
    }
    const auto end = std::chrono::steady_clock::now();
    walk.look_for_crossings(result.steps, true);
    if (!progress.cancelled()) walk.check_stability_at_end(result);
    result.solve_s += seconds_since(end);
    add_warnings(result);
    result.iterations = walk.take_iterations();
    progress.advance("simulate", 1);
    return result;
}

std::vector<std::vector<Vec3>> cable_points(const Model& model, std::span<const Vec3> positions) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    const std::span<const double> x(&positions.data()->x, 3 * positions.size());
    std::vector<std::vector<Vec3>> cables;
    for (const Cable& cable : model.description().cables) {
        std::vector<Vec3> points;
        for (const Attachment& point : cable.points) points.push_back(position(point, x));
        cables.push_back(std::move(points));
    }
    return cables;
}

}  // namespace pliant::sim
