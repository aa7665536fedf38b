#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/core/files.hpp"
#include "base/linalg/vectors.hpp"
#include "library/base/calls.hpp"
#include "library/base/in_use.hpp"
#include "library/simulation/data.hpp"
#include "simulation/run/describe.hpp"
#include "simulation/run/fields.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/stepper/state_file.hpp"

namespace pliant {
namespace {

/// Inputs change direction at any time: only the last state is useful for prediction.
sim::StepperOptions options_for(const sim::Program& program, const StepOptions& asked) {
    sim::StepperOptions options = sim::stepper_options(program);
    if (asked.tolerance) options.tolerance = *asked.tolerance;
    if (asked.iteration_limit) options.iteration_limit = *asked.iteration_limit;
    options.most_past = 1;
    if (!(options.tolerance > 0 && options.tolerance < 1))
        throw Failure(Failure::Kind::input,
                      fmt::format("a tolerance of {:g} is not possible: it is between 0 and 1", options.tolerance));
    if (options.iteration_limit < 0) throw Failure(Failure::Kind::input, "the iteration limit is negative");
    return options;
}

[[noreturn]] void refuse_time(const char* why, double from_s, double to_s) {
    throw Failure(Failure::Kind::input,
                  fmt::format("{}a step in time from {} s to {} s does not lead on", why, from_s, to_s));
}

/// One call may take many time steps, but it must end.
void check_time_steps(const sim::Stepper& stepper, double from_s, double to_s) {
    constexpr double most = 10000;
    const sim::StepperOptions& options = stepper.options();
    if (options.dynamics && (to_s - from_s) / options.time_unit > most)
        throw Failure(Failure::Kind::input,
                      fmt::format("from {:g} s to {:g} s are more than {:g} time steps of {:g} s; take several calls",
                                  from_s, to_s, most, options.time_unit));
}

}  // namespace

struct Stepper::Work {
    Work(std::shared_ptr<const Model::Data> data, const StepOptions& options)
        : model(std::move(data)), stepper(model->scene.model, options_for(model->scene.robot.program, options)) {}

    [[nodiscard]] const sim::RobotState& robot_of(const State& state) const {
        if (state.data().model == model) return state.data().robot;
        throw Failure(Failure::Kind::input, "the state is one of another model");
    }
    [[nodiscard]] State state_of(sim::RobotState robot) const {
        return State(std::make_shared<const State::Data>(State::Data{model, std::move(robot)}));
    }

    std::shared_ptr<const Model::Data> model;
    sim::Stepper stepper;
    library::InUse in_use{"stepper"};
};

Stepper::Stepper(const Model& model, const StepOptions& options)
    : work_(std::make_unique<Work>(model.data(), options)) {}
Stepper::Stepper(Stepper&&) noexcept = default;
Stepper& Stepper::operator=(Stepper&&) noexcept = default;
Stepper::~Stepper() = default;

State Stepper::rest() const {
    const library::Use use(work_->in_use);
    return work_->state_of(work_->stepper.rest());
}

Inputs Stepper::program(double time) const {
    if (!std::isfinite(time)) throw Failure(Failure::Kind::input, "the time is not finite");
    const library::Use use(work_->in_use);
    return library::inputs_of(work_->model->scene.model, work_->stepper.program(time));
}

StepResult Stepper::step(State& state, const Inputs& inputs, const Watch& watch) {
    const library::Use use(work_->in_use);
    sim::RobotState robot = work_->robot_of(state);
    const sim::Inputs wanted = library::inputs_for(work_->model->scene.model, inputs);
    const double from = robot.inputs.time;
    const bool in_time = work_->stepper.options().dynamics.has_value();
    const bool stays = in_time && work_->stepper.is_same_time(from, wanted.time);
    if (in_time && !stays && !(wanted.time > from)) refuse_time("", from, wanted.time);
    check_time_steps(work_->stepper, from, wanted.time);
    library::WatchedProgress progress(watch, "step");
    progress.advance("step", 0);
    const sim::StepReport report =
        work_->stepper.drive(robot, wanted, progress, nullptr, [&](double share) { progress.advance("step", share); });
    if (stays && !report.arrived) refuse_time("the inputs change, but ", from, wanted.time);
    const double residual = robot.evaluation.residual;
    state = work_->state_of(std::move(robot));
    progress.rethrow();
    if (progress.cancelled() && !report.arrived) library::check(cancelled());
    return {report.arrived, report.loose, report.reason, report.iterations, report.pieces, residual};
}

Observation Stepper::observe(const State& state) const {
    const library::Use use(work_->in_use);
    const sim::RobotState& robot = work_->robot_of(state);
    sim::Step step;
    sim::describe(work_->model->scene.model, work_->stepper.system(), robot.now.state, robot.controls, robot.evaluation,
                  step);
    if (work_->stepper.options().dynamics) step.kinetic_energy_J = work_->stepper.kinetic_energy_J(robot);
    return library::observation_of(step);
}

Fields Stepper::fields(const State& state) const {
    const std::vector<Vec3> positions = linalg::points_of(work_->robot_of(state).x());
    sim::Fields fields = sim::compute_fields(work_->model->scene.model, positions);
    return {std::move(fields.J), std::move(fields.von_mises_Pa), std::move(fields.max_stretch),
            std::move(fields.energy_density_Pa)};
}

std::vector<Point> Stepper::contact_forces(const State& state) const {
    const library::Use use(work_->in_use);
    const sim::RobotState& robot = work_->robot_of(state);
    return library::points_of(
        linalg::points_of(work_->stepper.system().contact_node_forces(robot.now.state, robot.controls)));
}

std::vector<std::vector<Point>> Stepper::cable_paths(const State& state) const {
    const std::vector<Vec3> positions = linalg::points_of(work_->robot_of(state).x());
    std::vector<std::vector<Point>> paths;
    for (const std::vector<Vec3>& path : sim::cable_points(work_->model->scene.model, positions))
        paths.push_back(library::points_of(path));
    return paths;
}

State Stepper::state_from(std::string_view bytes) const {
    const library::Use use(work_->in_use);
    return work_->state_of(library::value_of(sim::state_from_bytes(work_->stepper, bytes)));
}

State Stepper::load(const std::filesystem::path& file) const {
    const library::Use use(work_->in_use);
    const std::string bytes = library::value_of(read_file(file));
    auto robot = sim::state_from_bytes(work_->stepper, bytes);
    if (!robot)
        throw Failure(Failure::Kind::input, fmt::format("{}: {}", file.string(), robot.error().message), file.string());
    return work_->state_of(std::move(*robot));
}

}  // namespace pliant
