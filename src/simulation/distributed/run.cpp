#include "simulation/distributed/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/core/stopwatch.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/distributed/newton.hpp"
#include "simulation/run/warnings.hpp"

namespace pliant::sim::distributed {
namespace {

constexpr double smallest_share = 1.0 / 64;  // of a step of the program
constexpr double rounding = 1e-7;            // of the shortest substep
// Errors of predicted states, as in stepper/prediction.cpp.
constexpr double worst_start = 0.2, good_start = 0.03;
constexpr double predicted_rotation_error = 1e-4;

/// Each marker belongs to one rank: positions are sums over the ranks.
std::vector<Vec3> marker_positions(const DistributedEquilibrium& system, const Eigen::VectorXd& x) {
    const auto& markers = system.part().markers;
    std::vector<double> sums(3 * markers.size(), 0.0);
    for (std::size_t m = 0; m < markers.size(); ++m) {
        const Vec3 place = position(markers[m].point, linalg::view(x));
        for (std::size_t c = 0; c < 3; ++c) sums[3 * m + c] = place[c];
    }
    system.ranks().add_up(sums);
    std::vector<Vec3> places;
    for (std::size_t m = 0; m < markers.size(); ++m) places.push_back({sums[3 * m], sums[3 * m + 1], sums[3 * m + 2]});
    return places;
}

/// Fills in the record of a state, without positions.
void describe(const DistributedEquilibrium& system, const State& state, const Controls& controls,
              const Evaluation& evaluation, Step& step) {
    const Description& d = system.part();
    step.residual = evaluation.residual;
    step.min_J = evaluation.min_J;
    step.energy_J = system.potential_energy(state, controls);
    const std::vector<double> measures = system.measures(state.x);
    for (std::size_t a = 0; a < d.steered_count(); ++a) {
        const double ratio = measures[a] / system.rest_measure(a);
        const double multiplier = evaluation.multiplier[static_cast<Eigen::Index>(a)];
        if (a < d.cables.size())
            step.cables.push_back({d.cables[a].name, ratio, measures[a], multiplier});
        else
            step.chambers.push_back({d.chambers[a - d.cables.size()].name, ratio, measures[a], 0 - multiplier});
    }
    const std::vector<Vec3> reactions = system.reactions(evaluation);
    for (std::size_t s = 0; s < reactions.size(); ++s) step.supports.push_back({d.supports[s].name, reactions[s]});
    const std::vector<Vec3> markers = marker_positions(system, state.x);
    for (std::size_t m = 0; m < markers.size(); ++m) step.markers.push_back({d.markers[m].name, markers[m]});
}

class Run {
public:
    Run(const DistributedEquilibrium& system, const Program& program, RunOptions options)
        : system_(system),
          program_(program),
          options_(std::move(options)),
          local_(local_pattern(system)),
          linear_(system, local_, options_.preconditioner),
          rotation_(system, local_) {}

    Result<RunResult> run() {
        if (Status status = begin(); !status) return tl::unexpected(status.error());
        for (int k = now_.step + 1; k <= program_.steps; ++k) {
            Step step;
            step.index = k;
            if (!go_to(step)) break;
            if (Status status = keep(std::move(step)); !status) return tl::unexpected(status.error());
        }
        add_warnings(now_.so_far);
        return RunResult{std::move(now_.so_far), linear_.work(), rotation_.work()};
    }

private:
    Status begin() {
        if (options_.begin) {
            now_ = *std::exchange(options_.begin, std::nullopt);
            now_.so_far.setup_s += since_construction_.read_s();
            return {};
        }
        now_.now = {0, system_.rest()};
        now_.so_far.solver = name(Solver::newton);
        Step rest;
        const Controls controls = system_.controls(0);
        describe(system_, now_.now.state, controls, system_.evaluate(now_.now.state, controls), rest);
        now_.so_far.setup_s += since_construction_.read_s();
        return add(std::move(rest));
    }

    /// False: not converged; the trajectory says why.
    bool go_to(Step& step) {
        Stopwatch watch;
        step.time = program_.duration * static_cast<double>(step.index) / program_.steps;
        const double shortest = smallest_share * program_.duration / program_.steps;
        double piece = step.time - now_.now.along;
        step.substeps = 0;
        while (now_.now.along < step.time) {
            const double along = now_.now.along + piece;
            StepOutcome outcome = go(along >= step.time - rounding * shortest ? step.time : along, step);
            if (outcome.converged) continue;
            piece *= 0.5;
            if (piece >= shortest && !met_) continue;
            now_.so_far.converged = false;
            now_.so_far.message =
                fmt::format("stopped at step {} of {}: {}", step.index, program_.steps, outcome.reason);
            return false;
        }
        step.solver = Solver::newton;
        step.wall_s = watch.read_s();
        now_.so_far.solve_s += step.wall_s;
        return true;
    }

    /// In one step to `along`.
    StepOutcome go(double along, Step& step) {
        const Controls controls = system_.controls(along);
        State next = start(along, controls);
        StepOutcome outcome;
        if (const Evaluation e = system_.evaluate(next, controls); !e.possible())
            outcome.reason = fmt::format("the prescribed motion {}", name(e.flaw));
        else
            outcome = solve_step(system_, linear_, rotation_, controls,
                                 {program_.tolerance, program_.iteration_limit, 0}, next);
        step.iterations += outcome.iterations;
        for (IterationRecord record : outcome.history) {
            record.step = step.index;
            record.time = along;
            now_.so_far.iterations.push_back(record);
        }
        if (outcome.converged && options_.meets && options_.meets(now_.now.state.x, next.x)) {
            met_ = true;
            outcome.converged = false;
            outcome.reason =
                "the robot meets itself, and pliant-mpi does not support contact; pliant simulate does, or "
                "[contact] with self = false lets it pass through itself";
        }
        if (!outcome.converged) return outcome;
        ++step.substeps;
        now_.past.push_back(std::exchange(now_.now, {along, std::move(next)}));
        if (now_.past.size() > RotatingStep::most_past) now_.past.erase(now_.past.begin());
        if (along == program_.duration * static_cast<double>(step.index) / program_.steps)
            describe(system_, now_.now.state, controls, outcome.evaluation, step);
        return outcome;
    }

    /// The k-th state back: 0 is the last one.
    [[nodiscard]] const Moment& moment(std::size_t k) const {
        return k == 0 ? now_.now : now_.past[now_.past.size() - k];
    }

    /// Predicted from the last four states or, if that is far from equilibrium, from fewer, whichever is nearest. If
    /// none is near: the last state, with its supports moved.
    State start(double along, const Controls& controls) {
        std::optional<State> best;
        double least = worst_start;
        for (std::size_t count = now_.past.size() + 1; count >= 2 && least > good_start; --count) {
            State next = onward(along, count, controls);
            const Evaluation e = system_.evaluate(next, controls);
            if (!e.possible() || !(e.error() < least)) continue;
            least = e.error();
            best = std::move(next);
        }
        return best ? *std::move(best) : follow_supports(controls);
    }

    /// Extrapolates the polynomial through the last `count` states: of the multipliers and, for each tet, of its
    /// rotation and stretch.
    State onward(double along, std::size_t count, const Controls& controls) {
        std::vector<double> shares(count, 1.0);  // Lagrange's polynomials, the latest state first
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t other = 0; other < count; ++other)
                if (other != k) shares[k] *= (along - moment(other).along) / (moment(k).along - moment(other).along);
        State next{now_.now.state.x, shares[0] * now_.now.state.multiplier};
        system_.place_supports(controls, next.x);
        RotatingStep rotating{.now = now_.now.state.x.data(), .end = next.x.data()};
        double beyond = 0;  // the sum of the shares of all states before this one
        for (std::size_t k = count - 1; k > 0; --k) {
            const State& before = moment(k).state;
            next.multiplier += shares[k] * before.multiplier;
            beyond += shares[k];
            rotating.past[k - 1] = before.x.data();
            rotating.weights[k - 1] = -beyond;
        }
        next.x = rotation_.rotate(rotating, predicted_rotation_error);
        for (std::size_t a = 0; a < system_.part().cables.size(); ++a) {
            double& tension = next.multiplier[static_cast<Eigen::Index>(a)];
            tension = std::max(tension, 0.0);
        }
        return next;
    }

    /// Moves the free nodes according to the tangent at the last state.
    State follow_supports(const Controls& controls) {
        State next = now_.now.state;
        system_.place_supports(controls, next.x);
        const Eigen::VectorXd motion = next.x - now_.now.state.x;
        if (!(system_.ranks().largest(motion.size() > 0 ? motion.cwiseAbs().maxCoeff() : 0.0) > 0)) return next;
        linear_.set_tangent(now_.now.state, true);
        Eigen::VectorXd follows;
        if (linear_.solve(-linear_.forces_of(motion), 1e-6, follows)) next.x += system_.nodes().with_ghosts(follows);
        return next;
    }

    Status keep(Step step) {
        now_.step = step.index;
        if (Status status = add(std::move(step)); !status) return status;
        return options_.on_checkpoint ? options_.on_checkpoint(now_) : Status{};
    }

    Status add(Step step) {
        Status status = options_.on_step ? options_.on_step(step, now_.now.state.x) : Status{};
        now_.so_far.steps.push_back(std::move(step));
        return status;
    }

    Stopwatch since_construction_;
    const DistributedEquilibrium& system_;
    const Program& program_;
    RunOptions options_;
    const LocalPattern local_;
    LinearSolver linear_;
    StepRotation rotation_;
    RunState now_;
    bool met_ = false;  ///< then shorter steps do not help
};

}  // namespace

Result<RunResult> run(const DistributedEquilibrium& system, const Program& program, RunOptions options) {
    return Run(system, program, std::move(options)).run();
}

}  // namespace pliant::sim::distributed
