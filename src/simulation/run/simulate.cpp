#include "simulation/run/simulate.hpp"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

#include "base/core/stopwatch.hpp"
#include "simulation/run/describe.hpp"
#include "simulation/run/left_open.hpp"
#include "simulation/run/position_file.hpp"
#include "simulation/run/warnings.hpp"

namespace pliant::sim {
namespace {

constexpr double smallest_share = 1.0 / 64;  // of a step of the program

/// The program, step by step: its state between two steps, and the solvers and checks.
class Run {
public:
    Run(const Model& model, const Program& program, RunOptions options)
        : program_(program),
          options_(std::move(options)),
          stepper_(model, stepper_options(program)),
          rest_(stepper_.rest()),
          checks_(stepper_, program, rest_) {
        const auto nodes = static_cast<std::size_t>(model.node_count());
        const auto steps = static_cast<std::size_t>(program.steps) + 1;
        if (steps * nodes * sizeof(Vec3) > options_.memory_bytes) file_ = PositionFile::make(steps, nodes);
    }

    Trajectory run(Progress& progress) {
        begin();
        for (int k = now_.step + 1; k <= program_.steps && now_.so_far.converged; ++k) {
            progress.advance("simulate", static_cast<double>(k - 1) / program_.steps);
            if (!go_to(k, progress)) break;
            now_.step = k;
            if (Status status = keep(); !status) {
                stop(k, status.error().message);
                break;
            }
        }
        end(progress);
        progress.advance("simulate", 1);
        return std::move(now_.so_far);
    }

private:
    void begin() {
        if (options_.begin) {
            now_ = *std::exchange(options_.begin, std::nullopt);
            checks_.set_state(now_.checks);
            for (Step& step : now_.so_far.steps) put_on_disk(step);
        } else {
            now_.robot = rest_;
            const Evaluation& start = rest_.evaluation;
            if (!start.possible()) {  // describe() needs forces, and nothing may follow from these
                now_.robot.evaluation.out_of_balance = Eigen::VectorXd::Zero(rest_.x().size());
                stop(0, fmt::format("the start {}", name(start.flaw)));
            }
            now_.checks = checks_.state();
            now_.so_far.solver = name(stepper_.solvers().first());
            now_.so_far.warnings = warnings_at_rest(stepper_.model());
            Step rest;
            describe(rest);
            add(std::move(rest));
        }
        now_.so_far.setup_s += since_construction_.read_s();
    }

    /// False: it did not converge; the trajectory says why.
    bool go_to(int k, const Progress& progress) {
        Stopwatch watch;
        const bool is_there = try_step(k, progress, watch);
        if (!is_there) now_.so_far.solve_s += watch.read_s();  // the iterations of a failed step count, too
        return is_there;
    }

    /// `watch` runs since the step began.
    bool try_step(int k, const Progress& progress, Stopwatch& watch) {
        Step step;
        step.index = k;
        const StepPath path = program_path(stepper_, program_, now_.robot, k);
        step.time = path.end;
        StepReport report;
        std::optional<RobotState> before;
        if (!program_.dynamics && stepper_.has_inertia()) before = now_.robot;
        if (!progress.cancelled()) report = stepper_.step(now_.robot, path, progress);
        Trajectory& result = now_.so_far;
        std::string falls;
        if (report.arrived && before)
            falls = falling(stepper_.system(), now_.robot.now.state, now_.robot.controls, before->x());
        if (report.arrived && falls.empty()) checks_.after_step(now_.robot, step, report, result.warnings, progress);
        for (IterationRecord record : report.history) {
            record.step = k;
            result.iterations.push_back(record);
        }
        if (!falls.empty()) {
            now_.robot = *std::move(before);
            falls_ = true;
            stop(k, falls);
            return false;
        }
        if (progress.cancelled() && !report.arrived) {
            result.converged = false;
            result.message = fmt::format("cancelled at step {} of {}", k, program_.steps);
            return false;
        }
        if (!report.arrived) {
            const bool is_impossible = program_.dynamics && report.no_start;
            stop(k, report.reason + (is_impossible ? "" : advice(stepper_, program_, now_.robot, step.time, progress)));
            return false;
        }
        step.iterations = report.iterations;
        step.substeps = report.pieces;
        step.refused = stepper_.is_adaptive() ? report.refused : 0;
        step.solver = report.solver;
        step.converged = !report.loose;
        if (report.loose) step.reason = report.reason;
        describe(step);
        checks_.warn_of_closed_gaps(now_.robot, k, result.warnings);
        checks_.warn_of_uncarried_loads(now_.robot, k, result.warnings);
        step.wall_s = watch.read_s();
        result.solve_s += step.wall_s;
        add(std::move(step));
        checks_.look_for_crossings(now_.robot, result.steps, false);
        return true;
    }

    void describe(Step& step) const {
        const RobotState& robot = now_.robot;
        sim::describe(stepper_.model(), stepper_.system(), robot.now.state, robot.controls, robot.evaluation, step);
        if (program_.dynamics) step.kinetic_energy_J = stepper_.kinetic_energy_J(robot);
    }

    void put_on_disk(Step& step) {
        if (file_) step.positions = file_->keep(static_cast<std::size_t>(step.index), step.positions);
    }

    void add(Step step) {
        put_on_disk(step);
        if (options_.on_step) options_.on_step(step);
        now_.so_far.steps.push_back(std::move(step));
    }

    [[nodiscard]] Status keep() {
        if (!options_.on_checkpoint || now_.step % options_.checkpoint_every != 0) return {};
        now_.checks = checks_.state();
        return options_.on_checkpoint(now_);
    }

    void stop(int k, const std::string& why) {
        now_.so_far.converged = false;
        now_.so_far.message = fmt::format("stopped at step {} of {}: {}", k, program_.steps, why);
    }

    void end(const Progress& progress) {
        Stopwatch watch;
        Trajectory& result = now_.so_far;
        checks_.look_for_crossings(now_.robot, result.steps, true);
        if (!progress.cancelled()) checks_.at_end(now_.robot, result);
        // At the end of the program the checks say what is left open.
        const bool checked = result.converged && !progress.cancelled() && can_tell_left_open(stepper_.model());
        if (!program_.dynamics && !checked && !falls_) {
            if (std::string held = held_by_nothing(stepper_.model()); !held.empty())
                result.warnings.push_back(std::move(held));
        }
        if (std::string braked = braked_turns(stepper_.model(), program_, result.steps); !braked.empty())
            result.warnings.push_back(std::move(braked));
        for (auto* find : {impossible_vacuums, squeezed_objects})
            for (std::string& warning : find(stepper_.model(), result.steps))
                result.warnings.push_back(std::move(warning));
        result.solve_s += watch.read_s();
        add_warnings(result);
    }

    Stopwatch since_construction_;
    const Program& program_;
    RunOptions options_;
    Stepper stepper_;
    RobotState rest_;
    RunChecks checks_;
    RunState now_;
    std::unique_ptr<PositionFile> file_;  ///< null: in memory
    bool falls_ = false;
};

}  // namespace

StepperOptions stepper_options(const Program& program) {
    return {program.solver,   program.tolerance,       program.iteration_limit,
            program.dynamics, RotatingStep::most_past, program.duration / program.steps};
}

StepPath program_path(const Stepper& stepper, const Program& program, const RobotState& robot, int k) {
    return {program.duration * static_cast<double>(k) / program.steps,
            [&](double time) { return stepper.controls(robot, time); },
            (stepper.is_adaptive() ? smallest_adaptive_share : smallest_share) * program.duration / program.steps};
}

Trajectory run(const Model& model, const Program& program, Progress& progress, RunOptions options) {
    return Run(model, program, std::move(options)).run(progress);
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
